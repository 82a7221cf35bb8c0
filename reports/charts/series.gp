# A metric over time, of all engines and of the truth. Engine, s, value, has a mark. In: quantity, what the y axis is called.
set xlabel 'time, s'
set ylabel quantity noenhanced

# what flies off leaves the picture instead of flattening the others: the picture ends a quarter of its height beyond the
# middle one of all engines' lowest and highest values
count = words(present)
array low[count]
array high[count]
stats data using 3 skip 1 nooutput
least = STATS_min
most = STATS_max
do for [i = 1:count] {
	stats data using (only(word(present, i), $3)) skip 1 nooutput
	low[i] = STATS_min
	high[i] = STATS_max
}
lower(i) = (sum [k = 1:count] (low[k] < low[i] || (low[k] == low[i] && k < i)))
higher(i) = (sum [k = 1:count] (high[k] > high[i] || (high[k] == high[i] && k < i)))
do for [i = 1:count] {
	if (lower(i) == count/2) { lowest = low[i] }
	if (higher(i) == count/2) { highest = high[i] }
}
room = 0.25*(highest - lowest)
lowest = least > lowest - room ? least : lowest - room
highest = most < highest + room ? most : highest + room
# what differs by rounding alone is a line
margin = 0.03*(highest - lowest) + 1e-6*(abs(highest) > abs(lowest) ? abs(highest) : abs(lowest)) + 1e-12
set yrange [lowest - margin:highest + margin]

plot for [engine in present] data using (only(engine, column(2))):3 skip 1 with lines linetype place(engine) notitle, \
	for [engine in present] data using (only(engine, $4 == 1 ? column(2) : NaN)):3 skip 1 \
		with points linetype place(engine) pointsize 0.9 notitle, \
	for [engine in present] NaN with linespoints linetype place(engine) title engine noenhanced
