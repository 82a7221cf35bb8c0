# Which engine is good for which scene. Scene, engine, status, metric, error, uncertainty, ms, class, cheapest, on front.
scenes = ''
stats data using (scenes = add(scenes, strcol(1)), 0) skip 1 nooutput
shown = ''
stats data using (shown = add(shown, strcol(2)), 0) skip 1 nooutput
set xrange [0.5:words(shown) + 0.5]
set yrange [words(scenes) + 0.5:0.5]
set xtics () rotate by -35 noenhanced
set ytics () noenhanced
do for [i = 1:words(shown)] { set xtics add (word(shown, i) i) }
do for [i = 1:words(scenes)] { set ytics add (word(scenes, i) i) }
unset grid
set key below maxrows 2 samplen 1.5
shades = '#1f6f4a #7fb89a #d9ead3'
sign(class, error, status) = class <= 3 ? sprintf('%.0e', error) : class == 4 ? 'no truth' : status
column_of(name) = place_in(shown, name)
row_of(name) = place_in(scenes, name)
set style fill solid 1 border linecolor '#bbbbbb'
plot for [i = 0:2] data using ($8 == i ? column_of(strcol(2)) : NaN):(row_of(strcol(1))):(0.5):(0.48) skip 1 \
		with boxxyerror fillcolor rgb word(shades, i + 1) title 'error '.word('≤0.1% ≤1% ≤10%', i + 1), \
	data using (column_of(strcol(2))):(row_of(strcol(1))):(sign($8, $5, strcol(3))):($8 == 0 ? 0xffffff : 0x000000) skip 1 \
		with labels font ',9' textcolor rgb variable noenhanced notitle, \
	data using ($9 == 1 ? column_of(strcol(2)) - 0.4 : NaN):(row_of(strcol(1))) skip 1 with points pointtype 3 pointsize 0.9 \
		linecolor '#000000' linewidth 2 title 'cheapest within 1 %'
