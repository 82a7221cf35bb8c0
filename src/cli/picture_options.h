// Values of options that pictures are made by: charts for a paper, and films.
#ifndef CK_PICTURE_OPTIONS_H
#define CK_PICTURE_OPTIONS_H

#include "command.h"

// --format pdf, and --width of a length from 3 to 100 cm. Errors: CK_BAD_INPUT.
ck_Status ck_picture_paper(ck_Arguments *arguments, const char *text, ck_Error *error);
ck_Status ck_picture_width(ck_Arguments *arguments, const char *text, ck_Error *error);

// --color of what colours tell, and --size WxH, px. Errors: CK_BAD_INPUT.
ck_Status ck_picture_color(ck_Arguments *arguments, const char *text, ck_Error *error);
ck_Status ck_picture_size(ck_Arguments *arguments, const char *text, ck_Error *error);

#endif
