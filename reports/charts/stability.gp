# Where each method fails over time step and stiffness, the limit that theory gives it, and the critical step that was
# found. Engine, step s, stiffness factor, status or 'critical', predicted step s, iterations, step
# in which a point falls by the spacing of numbers.
count = words(present)
columns = count > 4 ? 3 : count > 1 ? 2 : 1
rows = (count + columns - 1)/columns
states = 'ok unsettled overstretched energy_gain diverged clamped frozen aborted timed_out'
marks = '6 4 9 5 7 11 13 2 1'
shades = '#117733 #117733 #b8650a #aa3300 #aa0000 #666666 #666666 #000000 #000000'
found = ''
stats data using (found = add(found, strcol(4)), $2) skip 1 nooutput
shortest = STATS_min/2
set xrange [shortest:STATS_max*2]
# rows of one stiffness at several iterations stand above each other
lift = 1.8
shown(i, has_iterations) = strcol(4) eq word(states, i) && ($6 > 0) == has_iterations
stats data using 3 skip 1 nooutput
set yrange [STATS_min/3:STATS_max*5]
set logscale xy
set format xy '10^{%L}'
set xlabel 'time step, s'
set ylabel "stiffness / scene's"
unset title
has_panels = 1
log_axes = 'xy'
set multiplot layout rows, columns title title noenhanced margins 0.07, 0.98, 0.16, 0.94 spacing 0.08, 0.55/(rows + 2)
unset key
do for [engine in present] {
	set title engine offset 0, -0.5 noenhanced
	plot for [i = 1:words(states)] data using (only(engine, shown(i, 0) ? $2 : NaN)):3 skip 1 \
			with points pointtype int(word(marks, i)) pointsize 0.8 linecolor rgb word(shades, i) title word(states, i) noenhanced, \
		for [i = 1:words(states)] data using (only(engine, shown(i, 1) ? $2 : NaN)):(lift*$3) skip 1 \
			with points pointtype int(word(marks, i)) pointsize 0.8 linecolor rgb word(shades, i) \
			title word(states, i).sprintf(' of more iterations, drawn %g times higher', lift) noenhanced, \
		data using (only(engine, $5)):3 skip 1 smooth unique with lines linecolor '#000000' linewidth 2 dashtype 2 \
			title 'limit by theory', \
		data using (only(engine, strcol(4) eq 'critical' ? $2 : NaN)):3 skip 1 with points pointtype 3 pointsize 1.6 linecolor '#000000' \
			title 'critical step, bisected', \
		data using (only(engine, $7 > shortest ? $7 : NaN)):3 skip 1 with lines linecolor '#aa0000' linewidth 2 dashtype 3 \
			title 'a step falls by the spacing of numbers'
	load sources.'/axes.gp'
}
# the key, below all panels
unset xlabel
unset ylabel
unset title
unset tics
unset border
unset grid
unset logscale
set lmargin at screen 0.02
set rmargin at screen 0.98
set bmargin at screen 0.01
set tmargin at screen 0.08
set yrange [0:1]
set xrange [0:1]
set key center center horizontal maxcols 6 maxrows 2 samplen 4 width 2
plot for [i = 1:words(states)] (strstrt(found.' ', ' '.word(states, i).' ') ? 2 : NaN) with points pointtype int(word(marks, i)) \
		linecolor rgb word(shades, i) title (strstrt(found.' ', ' '.word(states, i).' ') ? word(states, i) : '') noenhanced, \
	2 with lines linecolor '#000000' linewidth 2 dashtype 2 title 'limit by theory', \
	2 with points pointtype 3 linecolor '#000000' title 'critical step, bisected', \
	2 with lines linecolor '#aa0000' linewidth 2 dashtype 3 title 'a step falls by the spacing of numbers'
unset multiplot
