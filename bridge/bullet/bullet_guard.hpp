// What every source of Bullet's bridge needs: nothing that is thrown reaches C.
#ifndef CK_BULLET_GUARD_HPP
#define CK_BULLET_GUARD_HPP

#include "engine.h"

#include <LinearMath/btScalar.h>
#include <cstdio>
#include <exception>
#include <new>

// Calls work, and turns what it throws into a status: nothing that Bullet or the library throws may reach C.
template <typename Work> ck_Status ck_bullet_guarded(ck_Error *error, Work work) noexcept {
    try {
        return work();
    } catch (const std::bad_alloc &) {
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    } catch (const std::exception &thrown) {
        return ck_fail(error, CK_REFUSED, "Bullet's bridge: %s", thrown.what());
    } catch (...) {
        return ck_fail(error, CK_REFUSED, "Bullet's bridge: an exception of unknown kind");
    }
}

// The engines are built a second time for Bullet in single precision, by other names.
#ifdef CK_BULLET_FLOAT
#define CK_BULLET_SUFFIX "-float"
#define CK_BULLET_IS_SINGLE true
#else
#define CK_BULLET_SUFFIX ""
#define CK_BULLET_IS_SINGLE false
#endif

// Of the library and its precision, as "3.24 double".
inline const char *ck_bullet_version(void) {
    static char text[24];
    std::snprintf(text, sizeof text, "%d.%02d %s", btGetVersion() / 100, btGetVersion() % 100,
                  sizeof(btScalar) == sizeof(double) ? "double" : "float");
    return text;
}

#endif
