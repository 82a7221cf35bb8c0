# Error against cost over time steps and iterations. Engine, CPU s, error, on its engine's front, on the front, the
# truth's uncertainty, the share of a step's fall
# that is the spacing of numbers.
set logscale xy
log_axes = 'xy'
set format x '10^{%L}'
set format y '10^{%L}'
set xlabel 'CPU time for the scene, s'
set ylabel 'rms distance to the truth / size'
do for [level in '0.1 0.01 0.001'] {
	set arrow from graph 0, first (level + 0) to graph 1, first (level + 0) nohead linecolor '#444444' dashtype 3
	set label sprintf('%g %%', 100*(level + 0)) at graph 0.995, first (level + 0) right offset 0, 0.5 textcolor '#444444'
}
floor = -1
stats data using (floor = larger(floor, strcol(6)), 0) skip 1 nooutput
if (floor > 0) {
	set arrow from graph 0, first floor to graph 1, first floor nohead dashtype 2 linecolor '#444444'
	set label 'the truth is known to this' at graph 0.01, first floor left offset 0, 0.5 textcolor '#444444'
}
lost = 0
stats data using (lost = lost + ($7 >= 0.5), 0) skip 1 nooutput
set offsets graph 0.02, graph 0.04, graph 0.02, graph 0.05
plot data using ($5 == 1 ? $2 : NaN):3 skip 1 smooth unique with steps linecolor '#000000' linewidth 2.5 title 'Pareto front', \
	for [engine in present] data using (only(engine, column(2))):3 skip 1 with points linetype place(engine) pointsize 0.7 notitle, \
	for [engine in present] data using (only(engine, $4 == 1 ? column(2) : NaN)):3 skip 1 smooth unique \
		with linespoints linetype place(engine) pointsize 1 title engine noenhanced, \
	data using ($7 >= 0.5 ? $2 : NaN):3 skip 1 with points pointtype 6 pointsize 1.8 linecolor '#aa0000' \
		title (lost ? 'a step is lost in rounding' : '')
