#include "look.h"

// Told apart without colour; contrast with white is at least 4.5 for all. Beyond the table the colours come again with
// other marks.
ck_Look ck_chart_look(int engine) {
    static const ck_Look looks[] = {
        {"#00629b", 7, "●", "1"},  {"#b84300", 5, "■", "2"},  {"#00704f", 9, "▲", "3"},
        {"#5d3fa8", 13, "◆", "4"}, {"#7a5c10", 2, "×", "5"},  {"#5f5f5f", 1, "+", "(8,4)"},
        {"#b0237f", 6, "○", "1"},  {"#882255", 4, "□", "2"},  {"#9a5200", 8, "△", "3"},
        {"#1d6b2f", 12, "◇", "4"}, {"#332288", 10, "▽", "5"}, {"#707070", 3, "✱", "(2,4)"},
        {"#a01515", 14, "⬠", "1"}, {"#006d77", 15, "⬟", "2"},
    };
    const int count = sizeof looks / sizeof *looks;
    ck_Look look = looks[(engine + engine / count) % count];
    look.color = looks[engine % count].color;
    return look;
}
