# A metric against a swept key. Engine, x, y, panel, key, metric, error or value, scene. Lines of other keys' values are parted
# by empty lines.
unset title
stats data using 4 skip 1 nooutput
panels = int(STATS_max) + 1
columns = panels < 2 ? 1 : 2
rows = ceil(real(panels)/columns)
has_panels = 1
set multiplot layout rows, columns title title noenhanced margins 0.09,0.98,0.16,0.9 spacing 0.11,0.15
do for [p = 0:panels - 1] {
	key = ''; metric = ''; of = ''; scene = ''
	stats data using ($4 == p ? (key = strcol(5), metric = strcol(6), of = strcol(7), scene = strcol(8), $2) : NaN) skip 1 nooutput
	unset logscale
	log_axes = ''
	set format xy '%g'
	if (STATS_min > 0 && STATS_max > 8*STATS_min) { set logscale x; log_axes = 'x' }
	stats data using ($4 == p ? $3 : NaN) skip 1 prefix 'Y' nooutput
	if (of eq 'error' || of eq 'cost' || (Y_min > 0 && Y_max > 20*Y_min)) { set logscale y; log_axes = log_axes.'y'; set format y '10^{%L}' }
	set xlabel key noenhanced
	label = of eq 'error' ? metric.', distance to the truth' : metric eq 'cost' ? 'CPU, ms per simulated second' : of eq 'cost' ? metric.', s of CPU' : metric
	set ylabel label noenhanced
	set title scene noenhanced
	# one legend for all
	if (p) { unset key } else { set key at screen 0.5, 0.01 center bottom horizontal maxrows 3 samplen 1 font ',10' }
	plot for [engine in present] data using ($4 == p ? only(engine, $2) : NaN):3 skip 1 \
		with linespoints linetype place(engine) title engine noenhanced
	load sources.'/axes.gp'
}
unset multiplot
