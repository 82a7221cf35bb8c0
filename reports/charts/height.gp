# How high the lowest particle is above its nearest collider, against time. In: sources, this directory.
quantity = 'gap to the nearest collider / spacing'
load sources.'/series.gp'
