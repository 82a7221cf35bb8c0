#include "token.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define DIGITS (CK_TOKEN_SIZE - 1)

bool ck_token_draw(char token[CK_TOKEN_SIZE]) {
    unsigned char bytes[DIGITS / 2];
    const int file = open("/dev/urandom", O_RDONLY | O_CLOEXEC);
    const bool has = file >= 0 && read(file, bytes, sizeof bytes) == (ssize_t)sizeof bytes;
    if (file >= 0) close(file);
    for (size_t i = 0; i < sizeof bytes && has; i++) snprintf(token + 2 * i, 3, "%02x", bytes[i]);
    return has;
}

// Only what this user alone can have written and read is a secret.
static bool read_kept(char token[CK_TOKEN_SIZE], const char *path) {
    struct stat about;
    const int file = open(path, O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
    if (file < 0) return false;
    const bool is_own = !fstat(file, &about) && S_ISREG(about.st_mode) && about.st_uid == getuid() &&
                        !(about.st_mode & 077) && about.st_size == DIGITS;
    const bool is_read = is_own && read(file, token, DIGITS) == DIGITS;
    close(file);
    token[DIGITS] = '\0';
    return is_read && strspn(token, "0123456789abcdef") == DIGITS;
}

// A token that cannot be kept is one for this time.
static void keep(const char *token, const char *path) {
    unlink(path);
    const int file = open(path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
    if (file < 0) return;
    if (write(file, token, DIGITS) != DIGITS) unlink(path);
    close(file);
}

bool ck_token_of_port(char token[CK_TOKEN_SIZE], int port) {
    const char *directory = getenv("XDG_RUNTIME_DIR");
    char path[4096];
    const bool is_kept = port > 0 && directory && *directory == '/' &&
                         snprintf(path, sizeof path, "%s/clothcheck-view-%d", directory, port) < (int)sizeof path;
    if (is_kept && read_kept(token, path)) return true;
    if (!ck_token_draw(token)) return false;
    if (is_kept) keep(token, path);
    return true;
}
