# Iterations against substeps at equal cost: of lines above each other at one cost, the lower is the better way to spend
# it. Engine, iterations, CPU s, error.
count = words(present)
columns = count > 4 ? 3 : count > 1 ? 2 : 1
rows = (count + columns - 1)/columns
stats data using 3 skip 1 nooutput
set xrange [STATS_min/1.5:STATS_max*1.5]
stats data using 4 skip 1 nooutput
set yrange [STATS_min/2:STATS_max*2]
# all numbers of iterations, in their order: each has its mark in every panel
found = ''
stats data using (found = add(found, strcol(2)), 0) skip 1 nooutput
levels = ''
do for [i = 1:words(found)] {
	least = ''
	do for [level in found] {
		if (!place_in(levels, level) && (least eq '' || real(level) < real(least))) { least = level }
	}
	levels = levels.' '.least
}
set logscale xy
set format xy '10^{%L}'
set xlabel 'CPU time for the scene, s'
set ylabel 'error'
unset title
has_panels = 1
log_axes = 'xy'
set multiplot layout rows, columns title title noenhanced
set key outside below horizontal samplen 1.5 font ',9'
do for [engine in present] {
	own = ''
	stats data using (strcol(1) eq engine ? (own = add(own, strcol(2)), 0) : NaN) skip 1 nooutput
	set title engine noenhanced
	plot for [level in levels] data using (only(engine, strcol(2) eq level ? $3 : NaN)):4 skip 1 smooth unique \
		with linespoints linecolor '#204060' dashtype place_in(levels, level) pointtype 3 + place_in(levels, level) pointsize 0.8 \
		title (place_in(own, level) ? level.(level eq '1' ? ' iteration' : ' iterations') : '')
	load sources.'/axes.gp'
}
unset multiplot
