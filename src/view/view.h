// A scene in the browser, while it is stepped: a small server on this machine alone.
#ifndef CK_VIEW_H
#define CK_VIEW_H

#include "live.h"

typedef struct ck_ViewOptions {
    int port;           // 0: one that is free
    const char *folder; // where a session is saved
    bool waits;         // begins when somebody says so
    double real_time;   // times as fast as it is; 0: as fast as it can
} ck_ViewOptions;

// Serves a page on 127.0.0.1 until a signal comes or the last viewer says that it is over. Calls ready with the page's
// address, which holds a token, once there is one.
//
// Only that page is served, to whom has the token, and its stream only to that page: a request with another host, or
// from another origin, is refused. Positions go out as one binary message a frame:
//   u32 frame, f32 s, u32 1 where it plays, u32 engines; of each engine u32 ck_RunStatus + 1 where it has ended, else
//   0, and f32 ms of CPU and of wall time, sag, largest strain, distance to the first engine; and of each f32[3*shown]
// A viewer that has two unanswered misses those in between. Another frame rate makes *live another.
// Errors: CK_IO, CK_NO_MEMORY.
ck_Status ck_view_run(ck_Live **live, const ck_ViewOptions *options, void (*ready)(void *context, const char *address),
                      void *context, ck_Error *error);

#endif
