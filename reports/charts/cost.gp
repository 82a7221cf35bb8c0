# Error against cost: the nearer to the lower left, the better. Engine, ms, error, uncertainty, on front, metric, status,
# error of moving nothing.
set logscale xy
log_axes = 'xy'
set format x '10^{%L}'
set format y '10^{%L}'
set xlabel 'CPU time per simulated second, ms'
metric = ''
floor = -1
nothing = -1
stats data using (metric = strcol(6), floor = larger(floor, strcol(4)), nothing = larger(nothing, strcol(8)), 0) skip 1 nooutput
set ylabel 'error of '.metric noenhanced
set offsets graph 0.05, graph 0.05, graph 0.05, graph 0.05
if (floor > 0) {
	set arrow from graph 0, first floor to graph 1, first floor nohead dashtype 3 linecolor '#444444'
	set label 'the truth is known to this' at graph 0.01, first floor left offset 0, 0.5 textcolor '#444444'
}
if (nothing > 0) {
	set yrange [*:3*nothing]
	set arrow from graph 0, first nothing to graph 1, first nothing nohead dashtype 2 linecolor '#444444'
	set label 'what moves nothing is off by this' at graph 0.01, first nothing left offset 0, 0.5 textcolor '#444444'
}
plot data using ($5 == 1 ? $2 : NaN):3 skip 1 smooth unique with steps linecolor '#000000' linewidth 1 title 'Pareto front', \
	for [engine in present] data using (only(engine, column(2))):3 skip 1 with points linetype place(engine) pointsize 1.4 \
		title engine noenhanced, \
	data using (strcol(7) eq 'ok' ? NaN : $2):3:7 skip 1 with labels left offset 1, 0 font ',10' noenhanced notitle
