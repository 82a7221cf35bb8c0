# What leaving a term out changes, in units of the tolerance. Left out, metric, change / tolerance.
terms = ''
count = 0
array term[1000]
known(name) = (sum [i = 1:count] (term[i] eq name ? i : 0))
learn(name) = known(name) ? known(name) : (count = count + 1, term[count] = name, count)
stats data using (learn(strcol(1))) skip 1 nooutput
metrics = ''
stats data using (metrics = add(metrics, strcol(2)), 0) skip 1 nooutput
set logscale x
log_axes = 'x'
set format x '10^{%L}'
set xlabel 'change / tolerance: what is right of the line is needed; what is beyond the axis stands at its end'
set xrange [5e-5:2e4]
set yrange [count + 0.6:0.4]
set ytics () noenhanced
do for [i = 1:count] { set ytics add (term[i] i) }
set arrow from first 1, graph 0 to first 1, graph 1 nohead linecolor '#000000' dashtype 2
plot for [i = 1:words(metrics)] data using (strcol(2) eq word(metrics, i) ? $3 : NaN):(known(strcol(1))) skip 1 \
	with points linecolor '#204060' pointtype i pointsize 1.2 title word(metrics, i) noenhanced
