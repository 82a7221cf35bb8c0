# Iterations against substeps at equal cost: of lines above each other at one number of sweeps, the lower is the better
# way to spend them. Engine, iterations, sweeps, error.
count = words(present)
columns = count > 4 ? 3 : count > 1 ? 2 : 1
rows = (count + columns - 1)/columns
stats data using 3 skip 1 nooutput
set xrange [STATS_min/1.5:STATS_max*1.5]
stats data using 4 skip 1 nooutput
set yrange [STATS_min/2:STATS_max*2]
set logscale xy
set format xy '10^{%L}'
set xlabel 'sweeps per frame'
set ylabel 'error'
unset title
set multiplot layout rows, columns title title noenhanced
set key inside left bottom samplen 1.5 font ',9'
do for [engine in present] {
	levels = ''
	stats data using (strcol(1) eq engine ? (levels = add(levels, strcol(2)), 0) : NaN) skip 1 nooutput
	set title engine noenhanced
	plot for [i = 1:words(levels)] data using (only(engine, strcol(2) eq word(levels, i) ? $3 : NaN)):4 skip 1 smooth unique \
		with linespoints linecolor '#204060' dashtype i pointtype 2*i + 2 pointsize 0.8 title word(levels, i).' iterations'
}
unset multiplot
