# Each metric's error by engine, and how well its truth is known. Engine, metric, error, uncertainty.
set logscale y
log_axes = 'y'
set format y '10^{%L}'
set ylabel "error, in the metric's unit; 0 stands at 10^{-16}"
metrics = ''
stats data using (metrics = add(metrics, strcol(2)), 0) skip 1 nooutput
set xrange [0.4:words(metrics) + 0.6]
set xtics () rotate by -20 noenhanced
do for [i = 1:words(metrics)] { set xtics add (word(metrics, i) i) }
shift(engine) = (place_in(present, engine) - 0.5*(words(present) + 1))*0.75/words(present)
set style fill solid 0.25 border
set boxwidth 0.85
plot data using (place_in(metrics, strcol(2))):4 skip 1 smooth unique with boxes linecolor '#808080' title "truth's uncertainty", \
	for [engine in present] data using (only(engine, place_in(metrics, strcol(2)) + shift(engine))):3 skip 1 \
		with points linetype place(engine) pointsize 1 title engine noenhanced
