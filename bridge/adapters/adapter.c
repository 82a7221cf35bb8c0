// An engine in a program of its own, which is talked to as a command.
#include "serve.h"

extern const ck_Engine CK_ADAPTER_ENGINE;

int main(void) {
    return ck_serve(&CK_ADAPTER_ENGINE);
}
