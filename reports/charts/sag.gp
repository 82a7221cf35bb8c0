# Sag against time. In: sources, this directory.
quantity = 'largest drop below the highest pin / size'
load sources.'/series.gp'
