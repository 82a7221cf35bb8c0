# How far engines' paths are from each other. Engine, other engine, deviation / size.
count = words(present)
set xrange [0.5:count + 0.5]
set yrange [count + 0.5:0.5]
set xtics () rotate by -35 noenhanced
set ytics () noenhanced
do for [i = 1:count] {
	set xtics add (word(present, i) i)
	set ytics add (word(present, i) i)
}
unset grid
unset key
set cblabel 'rms distance of paths / size'
set palette defined (0 '#ffffff', 1 '#b8c9d9', 2 '#204060')
set logscale cb
set cbrange [1e-6:1]
set format cb '10^{%L}'
set style fill solid 1 border linecolor '#ffffff'
bounded(x) = x < 1e-6 ? 1e-6 : x > 1 ? 1 : x
plot data using (place_in(present, strcol(1))):(place_in(present, strcol(2))):(0.5):(0.5):(bounded($3)) skip 1 \
		with boxxyerror fillcolor palette, \
	data using (place_in(present, strcol(1))):(place_in(present, strcol(2))):(sprintf('%.0e', $3)):($3 > 0.02 ? 0xffffff : 0x000000) skip 1 \
		with labels font ',9' textcolor rgb variable
has_panels = 1
