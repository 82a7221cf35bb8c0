// What every source of Bullet's bridge needs: nothing that is thrown reaches C.
#ifndef CK_BULLET_GUARD_HPP
#define CK_BULLET_GUARD_HPP

#include "engine.h"

#include <LinearMath/btAlignedAllocator.h>
#include <LinearMath/btScalar.h>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

// Bullet's own allocators return nothing where there is no memory, and Bullet writes to that.
inline void *ck_bullet_allocate(std::size_t size) {
    if (void *memory = std::malloc(size)) return memory;
    throw std::bad_alloc();
}

inline void *ck_bullet_allocate_aligned(std::size_t size, int alignment) {
    void *memory;
    if (!posix_memalign(&memory, static_cast<std::size_t>(alignment), size)) return memory;
    throw std::bad_alloc();
}

inline bool ck_bullet_takes_allocators() {
    btAlignedAllocSetCustom(ck_bullet_allocate, std::free);
    btAlignedAllocSetCustomAligned(ck_bullet_allocate_aligned, std::free);
    return true;
}

// Calls work, and turns what it throws into a status: nothing that Bullet or the library throws may reach C.
template <typename Work> ck_Status ck_bullet_guarded(ck_Error *error, Work work) noexcept {
    static const bool takes_allocators = ck_bullet_takes_allocators();
    try {
        return takes_allocators ? work() : CK_NO_MEMORY;
    } catch (const std::bad_alloc &) {
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    } catch (const std::exception &thrown) {
        return ck_fail(error, CK_REFUSED, "Bullet's bridge: %s", thrown.what());
    } catch (...) {
        return ck_fail(error, CK_REFUSED, "Bullet's bridge: an exception of unknown kind");
    }
}

// What a step that was guarded came to.
inline ck_StepResult ck_bullet_result(ck_Status status) {
    return status == CK_NO_MEMORY ? CK_STEP_NO_MEMORY : status ? CK_STEP_DIVERGED : CK_STEP_OK;
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
