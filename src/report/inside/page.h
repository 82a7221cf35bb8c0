// The report's one page: a template, what it includes, and the report's files packed into it.
#ifndef CK_PAGE_H
#define CK_PAGE_H

#include "report_data.h"

// Writes the page to path. The template is sources/page/page.html; in it a line "@include NAME" stands
// for a file of sources/page, or of the three.js library for "@include three/NAME", and "@report" for what the page
// is of: a JSON list of engines, scenes and charts, and each file that it needs as a script element, gzip in base64.
//   charts  directory of the charts that were drawn; drawn as of ck_charts_draw
// Errors: CK_IO, CK_BAD_INPUT where a replay is not whole, CK_NO_MEMORY; then there is no page.
ck_Status ck_page_write(const ck_ReportData *data, const char *sources, const char *charts, const bool *drawn,
                        const char *path, ck_Error *error);

#endif
