// What a model's body is made of, as far as truths, rules and metrics ask.
#ifndef CK_SHAPE_H
#define CK_SHAPE_H

#include "model.h"

#ifdef __cplusplus
extern "C" {
#endif

// True for particles joined one after the other by one spring each, and no others: a rope, or a network of such bars.
bool ck_shape_is_chain(const ck_Model *model);

// True for a chain whose springs are alike and start in one straight line.
bool ck_shape_is_even_chain(const ck_Model *model);

// True without pins and colliders, and with springs that start at rest: nothing but field and drag moves it.
bool ck_shape_is_falling(const ck_Model *model);

#ifdef __cplusplus
}
#endif

#endif
