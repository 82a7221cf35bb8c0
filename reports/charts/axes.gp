# Where the axes of what was plotted last lie on the drawing, for the page: a line of x and of y each their ends, where
# these are, in the drawing's units, y downwards, and whether it is a scale of logarithms. In: axes, the file, '' for none;
# height; log_axes.
if (axes ne '') {
	set print axes append
	print sprintf('%.17g %.17g %g %g %d %.17g %.17g %g %g %d', \
		GPVAL_X_MIN, GPVAL_X_MAX, GPVAL_TERM_XMIN, GPVAL_TERM_XMAX, strstrt(log_axes, 'x') > 0, \
		GPVAL_Y_MIN, GPVAL_Y_MAX, height - GPVAL_TERM_YMIN, height - GPVAL_TERM_YMAX, strstrt(log_axes, 'y') > 0)
	unset print
}
