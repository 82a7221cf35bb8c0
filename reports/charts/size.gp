# Cost against size. Engine, particles, s, 'second_time' (per simulated second) or 'growth_step_time' (per step).
set logscale xy
set format xy '10^{%L}'
set xlabel 'particles of a square cloth'
unset title
kinds = ''
stats data using (kinds = add(kinds, strcol(4)), 0) skip 1 nooutput
has_panels = 1
log_axes = 'xy'
set multiplot layout 1, words(kinds) title title noenhanced
set key outside below horizontal maxrows 4 samplen 1 font ',9'
if (place_in(kinds, 'second_time')) {
	set title 'at automatic settings'
	set ylabel 'CPU time per simulated second, s'
	plot for [engine in present] data using (only(engine, strcol(4) eq 'second_time' ? $2 : NaN)):3 skip 1 smooth unique \
		with linespoints linetype place(engine) title engine noenhanced
	load sources.'/axes.gp'
}
if (place_in(kinds, 'growth_step_time')) {
	set title 'native-verlet, one step'
	set ylabel 'CPU time per step, s'
	stats data using (strcol(4) eq 'growth_step_time' ? $3/$2 : NaN) skip 1 nooutput
	plot data using (strcol(4) eq 'growth_step_time' ? $2 : NaN):3 skip 1 with linespoints linetype place('native-verlet') title 'measured', \
		STATS_records ? STATS_median*x : NaN linecolor '#444444' dashtype 3 title 'as the number of particles'
	load sources.'/axes.gp'
}
unset multiplot
