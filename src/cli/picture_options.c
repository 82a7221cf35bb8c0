#include "picture_options.h"

#include <stdlib.h>
#include <string.h>

ck_Status ck_picture_paper(ck_Arguments *arguments, const char *text, ck_Error *error) {
    arguments->is_pdf = !strcmp(text, "pdf");
    return arguments->is_pdf ? CK_OK
                             : ck_fail(error, CK_BAD_INPUT, "--format %s: is none of a chart; it may be pdf", text);
}

ck_Status ck_picture_width(ck_Arguments *arguments, const char *text, ck_Error *error) {
    static const struct {
        const char *name;
        double cm;
    } units[] = {{"cm", 1}, {"mm", 0.1}, {"in", 2.54}};
    char *unit;
    const double number = strtod(text, &unit);
    arguments->has_width = true;
    arguments->paper_width = 0;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (unit != text && !strcmp(unit, units[i].name)) arguments->paper_width = number * units[i].cm;
    const bool is_fit = arguments->paper_width >= 3 && arguments->paper_width <= 100;
    return is_fit ? CK_OK
                  : ck_fail(error, CK_BAD_INPUT,
                            "--width %s: must be a width from 3cm to 100cm, as 8.5cm, 85mm or 3.35in", text);
}

ck_Status ck_picture_color(ck_Arguments *arguments, const char *text, ck_Error *error) {
    static const char *const colors[] = {"strain", "distance", "speed", "engine"};
    for (size_t i = 0; i < sizeof colors / sizeof *colors; i++)
        if (!strcmp(text, colors[i])) arguments->color = colors[i];
    return arguments->color
               ? CK_OK
               : ck_fail(error, CK_BAD_INPUT, "--color %s: must be strain, distance, speed or engine", text);
}

// Even numbers, for a video's colours are of two by two pixels.
ck_Status ck_picture_size(ck_Arguments *arguments, const char *text, ck_Error *error) {
    char *middle, *end;
    const long width = strtol(text, &middle, 10), height = *middle == 'x' ? strtol(middle + 1, &end, 10) : 0;
    const bool is_whole = *middle == 'x' && !*end;
    if (!is_whole || width < 200 || height < 200 || width > 3840 || height > 2160 || width % 2 || height % 2)
        return ck_fail(error, CK_BAD_INPUT,
                       "--size %s: must be two even numbers from 200x200 to 3840x2160, as 1280x720", text);
    arguments->film_width = (int)width;
    arguments->film_height = (int)height;
    return CK_OK;
}
