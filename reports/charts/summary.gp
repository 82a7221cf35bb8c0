# Which engine is good for which scene. Scene, engine, status, metric, error, uncertainty, ms, s timed, s of the longest,
# class, cheapest, on front, better than moving nothing.
scenes = ''
stats data using (scenes = add(scenes, strcol(1)), 0) skip 1 nooutput
shown = ''
stats data using (shown = add(shown, strcol(2)), 0) skip 1 nooutput
set xrange [0.5:words(shown) + 0.5]
set yrange [words(scenes) + 0.5:0.5]
set xtics () rotate by -35 noenhanced
set ytics () noenhanced font ',9'
do for [i = 1:words(shown)] { set xtics add (word(shown, i) i) }
do for [i = 1:words(scenes)] { set ytics add (word(scenes, i) i) }
unset grid
set key below maxrows 2 samplen 1.5 width 1
shades = '#1f6f4a #7fb89a #d9ead3 #f7e3d4 #ffffff #f0c4c4 #ededed'
kinds = '0 1 2 3 5 6'
meanings = 'error≤0.1% ≤1% ≤10% worse failed not_to_be_had'
spaced(text) = text eq 'not_to_be_had' ? 'not to be had' : text
# a number that is missing would take its row away; what is not to be had is told by its shade
sign(class, error, status) = class <= 3 ? sprintf('%.0e', real(error)) : class == 4 ? (error eq 'nan' ? 'no truth' : sprintf('%.0e', real(error))) : class == 5 ? status : ''
column_of(name) = place_in(shown, name)
row_of(name) = place_in(scenes, name)
set style fill solid 1 border linecolor '#bbbbbb'
plot for [i = 1:words(kinds)] data using ($10 == int(word(kinds, i)) ? column_of(strcol(2)) : NaN):(row_of(strcol(1))):(0.5):(0.48) skip 1 \
		with boxxyerror fillcolor rgb word(shades, int(word(kinds, i)) + 1) title spaced(word(meanings, i)) noenhanced, \
	data using (column_of(strcol(2))):(row_of(strcol(1))):(sign($10, strcol(5), strcol(3))):($10 == 0 ? 0xffffff : 0x000000) skip 1 \
		with labels font ',7' textcolor rgb variable noenhanced notitle, \
	data using ($11 == 1 ? column_of(strcol(2)) - 0.4 : NaN):(row_of(strcol(1))) skip 1 with points pointtype 3 pointsize 0.9 \
		linecolor '#000000' linewidth 2 title 'cheapest within 1 %'
has_panels = 1
