# Mechanical energy against time, of gravity and force counted from the start. In: sources, this directory.
quantity = 'energy, J'
load sources.'/series.gp'
