#include "text.h"

#include <stdlib.h>

bool ck_text_begin(ck_Text *text) {
    *text = (ck_Text){0};
    text->file = open_memstream(&text->bytes, &text->size);
    return text->file != NULL;
}

bool ck_text_end(ck_Text *text) {
    if (!text->file) return false;
    const bool has_failed = ferror(text->file) != 0;
    // glibc closes without a complaint where it cannot trim what it holds, and then holds nothing
    const bool is_whole = !fclose(text->file) && !has_failed && text->bytes;
    text->file = NULL;
    if (is_whole) return true;
    free(text->bytes);
    text->bytes = NULL;
    text->size = 0;
    return false;
}
