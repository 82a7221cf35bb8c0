// The secret in the address of the live page: whoever has it may look and act.
#ifndef CK_TOKEN_H
#define CK_TOKEN_H

#include <stdbool.h>

#define CK_TOKEN_SIZE 33 // of 32 hexadecimal digits, 128 bits

// A new one, of the system's random numbers. False where there are none.
bool ck_token_draw(char token[CK_TOKEN_SIZE]);

// The one of a port, so that a server that is started again on it has the address of before, and pages that are open
// find it. It is kept in $XDG_RUNTIME_DIR, which is this user's alone and empty after a restart; without that
// directory, or for port 0, it is a new one. False where there are no random numbers.
bool ck_token_of_port(char token[CK_TOKEN_SIZE], int port);

#endif
