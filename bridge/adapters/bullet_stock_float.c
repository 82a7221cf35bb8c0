// Bullet in single precision, as games ship it. The program holds Bullet in double precision, and the two share the
// names of their symbols: no process may hold both, so that this is one of its own.
#include "serve.h"

extern const ck_Engine ck_bullet_stock;

int main(void) {
    return ck_serve(&ck_bullet_stock);
}
