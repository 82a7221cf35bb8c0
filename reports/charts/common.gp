# What all charts share. 'looks.gp' before it says which engines there are, and how each looks: engines, place(name).
# In: data, the chart's CSV; title; axes, a file for axes.gp, which each script with panels of its own loads after each, or
# ''. Out: present, the engines in its first column. A script says in log_axes which axes have a scale of logarithms, and
# in has_panels whether it has several, or none of numbers.
log_axes = ''
has_panels = 0
if (axes ne '') {
	set print axes
	unset print
}
set datafile separator comma
# a row of another engine does not break the line of this one
set datafile missing NaN
set encoding utf8
set border linewidth 0.8 linecolor '#444444'
set grid linecolor '#d0d0d0' linewidth 0.6 dashtype 1
set tics nomirror
set key outside right top vertical Left reverse samplen 2 spacing 1.1
# a column of a paper has no room beside a chart, and a caption of its own
if (is_column) {
	set key outside below center vertical maxrows 4 Left reverse samplen 1 spacing 0.9 width -2 font ',10'
	set ylabel font ',10'
	title = ''
}
set title title noenhanced
set format y '%g'

add(list, word) = strstrt(list.' ', ' '.word.' ') ? list : list.' '.word
present = ''
stats data using (present = add(present, strcol(1)), 0) skip 1 nooutput

# the largest number of a column that may have none: then it stays -1
larger(most, text) = real(text) > most ? real(text) : most

# where a word stands in a list, from 1
place_in(list, name) = (sum [i = 1:words(list)] (word(list, i) eq name ? i : 0))
# one engine's rows of a column
only(engine, value) = strcol(1) eq engine ? value : NaN
