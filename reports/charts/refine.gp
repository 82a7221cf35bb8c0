# Metrics against the spacing of the mesh. Engine, spacing m, value, metric.
set logscale x
set xlabel 'spacing, m'
unset title
kinds = ''
stats data using (kinds = add(kinds, strcol(4)), $2) skip 1 nooutput
set xrange [STATS_max*1.3:STATS_min/1.3]
has_panels = 1
log_axes = 'x'
set multiplot layout 1, words(kinds) title title noenhanced
set key outside below horizontal maxrows 4 samplen 1 font ',9'
do for [kind in kinds] {
	set title kind noenhanced
	plot for [engine in present] data using (only(engine, strcol(4) eq kind ? $2 : NaN)):3 skip 1 smooth unique \
		with linespoints linetype place(engine) title engine noenhanced
	load sources.'/axes.gp'
}
unset multiplot
