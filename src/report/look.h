// How an engine looks wherever it is drawn: colour, mark and dashes by its place among the engines of a result.
#ifndef CK_LOOK_H
#define CK_LOOK_H

typedef struct ck_Look {
    const char *color; // #rrggbb
    int mark;          // gnuplot's point type
    const char *sign;  // the same as a character
    const char *dash;  // gnuplot's dash type
} ck_Look;
ck_Look ck_chart_look(int engine);

#endif
