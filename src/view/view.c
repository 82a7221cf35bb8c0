#include "view.h"

#include "intro.h"
#include "orders.h"
#include "template.h"
#include "text.h"
#include "token.h"

#include "springs.h"
#include "vector.h"

#include <civetweb.h>
#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <limits.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define VIEWERS 32
#define ORDERS 256      // that wait to be done
#define MOST_ORDER 2000 // letters
#define UNANSWERED 2    // frames that a viewer may be behind

typedef struct Viewer {
    struct mg_connection *connection; // NULL: none
    bool is_ready;                    // for frames
    int unanswered;
    long seen; // the last frame that was sent; −1: none
} Viewer;

typedef struct Order {
    const struct mg_connection *from; // that may have gone
    char text[MOST_ORDER];
    size_t length;
} Order;

typedef struct View {
    ck_Stage stage;
    struct mg_context *server;
    char token[CK_TOKEN_SIZE], nonce[CK_TOKEN_SIZE], host[40], other_host[40], origin[60], other_origin[60];
    char *page, *intro; // the page, and what a viewer is told first
    size_t page_size;
    pthread_mutex_t lock; // of what follows
    pthread_cond_t woken;
    Viewer viewers[VIEWERS];
    Order *orders; // [ORDERS], a ring
    int first_order, order_count;
    bool is_asked; // a viewer waits for the frame that is shown
} View;

// Equal in a time that does not tell where they differ.
static bool is_token(const View *view, const char *query) {
    const char *given = query ? strstr(query, "t=") : NULL;
    unsigned char differs = 0;
    if (!given || strlen(given + 2) != strlen(view->token)) return false;
    for (size_t i = 0; view->token[i]; i++) differs |= (unsigned char)(given[2 + i] ^ view->token[i]);
    return !differs;
}

// The page of another site cannot name this host with its own name, nor hide where it is from.
static bool is_ours(const View *view, const struct mg_connection *connection, bool needs_origin) {
    const struct mg_request_info *request = mg_get_request_info(connection);
    const char *host = mg_get_header(connection, "Host"), *origin = mg_get_header(connection, "Origin");
    if (!host || (strcmp(host, view->host) && strcmp(host, view->other_host))) return false;
    if (origin && strcmp(origin, view->origin) && strcmp(origin, view->other_origin)) return false;
    return (origin || !needs_origin) && is_token(view, request->query_string);
}

static int refuse(struct mg_connection *connection, int code, const char *words) {
    mg_printf(connection,
              "HTTP/1.1 %d %s\r\nContent-Type: text/plain\r\nContent-Length: %zu\r\nConnection: close\r\n\r\n%s", code,
              words, strlen(words), words);
    return code;
}

static int serve_page(struct mg_connection *connection, void *context) {
    const View *view = context;
    const struct mg_request_info *request = mg_get_request_info(connection);
    if (strcmp(request->request_method, "GET")) return refuse(connection, 405, "Only GET");
    if (strcmp(request->local_uri, "/")) return refuse(connection, 404, "There is one page");
    if (!is_ours(view, connection, false)) return refuse(connection, 403, "The address that was printed has a token");
    mg_printf(
        connection,
        "HTTP/1.1 200 OK\r\nContent-Type: text/html; charset=utf-8\r\nContent-Length: %zu\r\nCache-Control: "
        "no-store\r\nReferrer-Policy: no-referrer\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
        view->page_size);
    mg_write(connection, view->page, view->page_size);
    return 200;
}

static int greet(const struct mg_connection *connection, void *context) {
    View *view = context;
    int taken = 0;
    if (!is_ours(view, connection, true)) return 1;
    pthread_mutex_lock(&view->lock);
    for (int i = 0; i < VIEWERS; i++) taken += view->viewers[i].connection != NULL;
    pthread_mutex_unlock(&view->lock);
    return taken >= VIEWERS;
}

static void write_text(struct mg_connection *connection, const char *text) {
    mg_lock_connection(connection);
    mg_websocket_write(connection, MG_WEBSOCKET_OPCODE_TEXT, text, strlen(text));
    mg_unlock_connection(connection);
}

static void welcome(struct mg_connection *connection, void *context) {
    View *view = context;
    pthread_mutex_lock(&view->lock);
    int i = 0;
    while (i < VIEWERS && view->viewers[i].connection) i++;
    if (i < VIEWERS) view->viewers[i] = (Viewer){.connection = connection, .seen = -1};
    if (i < VIEWERS) write_text(connection, view->intro);
    pthread_mutex_unlock(&view->lock);
}

static Viewer *viewer_of(View *view, const struct mg_connection *connection) {
    for (int i = 0; i < VIEWERS; i++)
        if (view->viewers[i].connection == connection) return &view->viewers[i];
    return NULL;
}

// "+" is a viewer's answer to a frame; all else is an order. 0 ends the connection.
static int listen(struct mg_connection *connection, int bits, char *data, size_t length, void *context) {
    View *view = context;
    const int opcode = bits & 0xf;
    if (opcode == MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE) return 0;
    if (opcode != MG_WEBSOCKET_OPCODE_TEXT || !(bits & 0x80))
        return opcode == MG_WEBSOCKET_OPCODE_PING || opcode == MG_WEBSOCKET_OPCODE_PONG;
    pthread_mutex_lock(&view->lock);
    Viewer *viewer = viewer_of(view, connection);
    const bool is_answer = length == 1 && *data == '+';
    if (viewer && is_answer) {
        viewer->unanswered = viewer->unanswered > 0 ? viewer->unanswered - 1 : 0;
        viewer->is_ready = true;
        view->is_asked = true;
    }
    const bool fits = is_answer || (length < MOST_ORDER && view->order_count < ORDERS);
    if (!is_answer && fits) {
        Order *order = &view->orders[(view->first_order + view->order_count++) % ORDERS];
        order->from = connection;
        memcpy(order->text, data, length);
        order->length = length;
    }
    pthread_cond_signal(&view->woken);
    pthread_mutex_unlock(&view->lock);
    // who floods misses what is too much
    return 1;
}

static void part(const struct mg_connection *connection, void *context) {
    View *view = context;
    pthread_mutex_lock(&view->lock);
    Viewer *viewer = viewer_of(view, connection);
    if (viewer) *viewer = (Viewer){0};
    pthread_mutex_unlock(&view->lock);
}

static void put_positions(float *out, const ck_Model *model, const ck_Trajectory *shown) {
    const double *at = ck_trajectory_position(shown, 0);
    const ck_Turn *turn = ck_trajectory_turn(shown, 0);
    for (int i = 0; i < 3 * model->particle_count; i++) *out++ = (float)at[i];
    for (int i = 0; i < model->rigid_count; i++) {
        const double *center = at + 3 * model->rigid[i].particle, none[4] = {1, 0, 0, 0};
        const ck_Collider now =
            ck_rigid_place(&model->rigid[i], center, isnan(turn[i].rotation[0]) ? none : turn[i].rotation);
        for (int k = 0; k < 6; k++) *out++ = (float)(center[k % 3] + model->spacing * now.axes[k / 3][k % 3]);
    }
}

#define HEAD 4
#define OF_ENGINE 6

static size_t frame_numbers(const View *view) {
    const size_t engines = (size_t)ck_live_count(view->stage.live);
    return HEAD + engines * (OF_ENGINE + 3 * ck_intro_shown_count(ck_live_model(view->stage.live)));
}

static void put_u32(float *out, uint32_t number) {
    memcpy(out, &number, sizeof number);
}

static void fill_frame(const View *view, float *out) {
    const ck_Live *live = view->stage.live;
    const ck_Model *model = ck_live_model(live);
    const int count = ck_live_count(live);
    const ck_Metric *sag = ck_metric_find("sag");
    put_u32(out, (uint32_t)ck_live_frame(live));
    out[1] = (float)(ck_live_frame(live) * model->step);
    put_u32(out + 2, view->stage.plays);
    put_u32(out + 3, (uint32_t)count);
    float *of = out + HEAD, *positions = of + (size_t)count * OF_ENGINE;
    for (int i = 0; i < count; i++, of += OF_ENGINE, positions += 3 * ck_intro_shown_count(model)) {
        const ck_LiveEngine *engine = ck_live_engine(live, i);
        const double *at = ck_trajectory_position(&engine->shown, 0);
        const double *first = ck_trajectory_position(&ck_live_engine(live, 0)->shown, 0);
        double sum = 0;
        for (int k = 0; k < 3 * model->particle_count; k++) sum += (at[k] - first[k]) * (at[k] - first[k]);
        put_u32(of, engine->runs ? 0 : (uint32_t)engine->status + 1);
        of[1] = (float)(1e3 * engine->cpu);
        of[2] = (float)(1e3 * engine->wall);
        of[3] = (float)sag->at(model, &engine->shown, 0, NULL);
        of[4] = (float)ck_springs_largest_strain(model, at);
        of[5] = (float)(sqrt(sum / model->particle_count) / model->size);
        put_positions(positions, model, &engine->shown);
    }
}

// Sends the frame to whoever has answered the last ones. Who leaves does so before or after, as part() waits for it.
static void show_frame(View *view, float *frame, long number) {
    bool is_filled = false;
    pthread_mutex_lock(&view->lock);
    for (int i = 0; i < VIEWERS; i++) {
        Viewer *viewer = &view->viewers[i];
        if (!viewer->connection || !viewer->is_ready || viewer->unanswered >= UNANSWERED || viewer->seen == number)
            continue;
        if (!is_filled) fill_frame(view, frame);
        is_filled = true;
        viewer->unanswered++;
        viewer->seen = number;
        mg_lock_connection(viewer->connection);
        mg_websocket_write(viewer->connection, MG_WEBSOCKET_OPCODE_BINARY, (const char *)frame,
                           frame_numbers(view) * sizeof *frame);
        mg_unlock_connection(viewer->connection);
    }
    view->is_asked = false;
    pthread_mutex_unlock(&view->lock);
}

static void tell_all(View *view, const char *text) {
    pthread_mutex_lock(&view->lock);
    for (int i = 0; i < VIEWERS; i++)
        if (view->viewers[i].connection) write_text(view->viewers[i].connection, text);
    pthread_mutex_unlock(&view->lock);
}

// To one viewer, where it is still there.
static void tell_one(View *view, const struct mg_connection *connection, const char *text) {
    pthread_mutex_lock(&view->lock);
    const Viewer *viewer = viewer_of(view, connection);
    if (viewer) write_text(viewer->connection, text);
    pthread_mutex_unlock(&view->lock);
}

// Why engines have ended, once each.
static void tell_ends(View *view, bool *told) {
    for (int i = 0; i < ck_live_count(view->stage.live); i++) {
        const ck_LiveEngine *engine = ck_live_engine(view->stage.live, i);
        if (engine->runs) told[i] = false;
        if (engine->runs || told[i]) continue;
        json_t *end = json_pack("{s:s, s:i, s:s, s:s}", "kind", "ended", "engine", i, "status",
                                ck_run_status_names[engine->status], "text", engine->reason);
        char *text = end ? json_dumps(end, JSON_COMPACT) : NULL;
        if (text) tell_all(view, text);
        free(text);
        json_decref(end);
        told[i] = true;
    }
}

// The next order, waiting for one or for the time, s; false where there is none.
static bool next_order(View *view, double until, Order *order) {
    pthread_mutex_lock(&view->lock);
    const double left = until - ck_wall();
    if (!view->order_count && !view->is_asked && left > 0) {
        struct timespec end;
        clock_gettime(CLOCK_REALTIME, &end);
        const double at = (double)end.tv_sec + 1e-9 * (double)end.tv_nsec + fmin(left, 0.2);
        end.tv_sec = (time_t)at;
        end.tv_nsec = (long)(1e9 * (at - floor(at)));
        pthread_cond_timedwait(&view->woken, &view->lock, &end);
    }
    const bool has = view->order_count > 0;
    if (has) {
        *order = view->orders[view->first_order];
        view->first_order = (view->first_order + 1) % ORDERS;
        view->order_count--;
    }
    pthread_mutex_unlock(&view->lock);
    return has;
}

// Another session than that of before: all viewers begin again. Without memory they go on with what they know.
static void begin_again(View *view) {
    char *intro = ck_intro_make(view->stage.live);
    if (!intro) return;
    pthread_mutex_lock(&view->lock);
    free(view->intro);
    view->intro = intro;
    pthread_mutex_unlock(&view->lock);
    tell_all(view, intro);
}

// Does what is asked until a time, s.
static bool obey_until(View *view, double until) {
    Order order;
    char answer[1000];
    bool any = false;
    while (next_order(view, until, &order)) {
        const ck_Live *before = view->stage.live;
        any = true;
        const bool is_for_all = ck_stage_obey(&view->stage, order.text, order.length, answer, sizeof answer);
        if (view->stage.live != before) begin_again(view);
        if (*answer && is_for_all) tell_all(view, answer);
        if (*answer && !is_for_all) tell_one(view, order.from, answer);
    }
    return any;
}

static void run(View *view, float *frame) {
    ck_Stage *stage = &view->stage;
    bool told[CK_LIVE_ENGINES] = {0};
    double due = ck_wall();
    for (long number = 0; !ck_child_interrupted;) {
        number += obey_until(view, stage->plays || stage->steps ? due : ck_wall() + 0.2);
        const double now = ck_wall();
        const bool is_due = stage->steps || (stage->plays && now >= due);
        if (is_due) {
            ck_stage_step(stage);
            if (stage->steps) stage->steps--;
            const double step = ck_live_model(stage->live)->step;
            // who cannot keep up is not chased
            due = stage->real_time > 0 ? fmax(due + step / stage->real_time, now) : now;
            number++;
        } else if (!stage->plays) {
            due = now;
        }
        tell_ends(view, told);
        show_frame(view, frame, number);
    }
}

static ck_Status make_page(View *view, ck_Error *error) {
    char sources[PATH_MAX];
    ck_Status status = ck_template_sources(sources, sizeof sources, error);
    ck_Text page = {0};
    if (!status && !ck_text_begin(&page)) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) status = ck_template_write(page.file, sources, "view.html", view->nonce, NULL, NULL, error);
    if (!ck_text_end(&page) && !status) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    view->page = page.bytes;
    view->page_size = page.size;
    return status;
}

static ck_Status start_server(View *view, int wanted, char *address, size_t size, ck_Error *error) {
    char listening[40];
    struct mg_callbacks callbacks = {0};
    struct mg_server_port port[1];
    snprintf(listening, sizeof listening, "127.0.0.1:%d", wanted);
    const char *options[] = {"listening_ports",
                             listening,
                             "num_threads",
                             "40",
                             "websocket_timeout_ms",
                             "3600000",
                             "request_timeout_ms",
                             "5000",
                             "enable_directory_listing",
                             "no",
                             "tcp_nodelay",
                             "1",
                             NULL};
    mg_init_library(0);
    view->server = mg_start(&callbacks, view, options);
    if (!view->server || mg_get_server_ports(view->server, 1, port) < 1)
        return ck_fail(error, CK_IO, "port %d of this machine cannot be had: --port takes another, 0 any that is free",
                       wanted);
    snprintf(view->host, sizeof view->host, "127.0.0.1:%d", port[0].port);
    snprintf(view->other_host, sizeof view->other_host, "localhost:%d", port[0].port);
    snprintf(view->origin, sizeof view->origin, "http://%s", view->host);
    snprintf(view->other_origin, sizeof view->other_origin, "http://%s", view->other_host);
    snprintf(address, size, "http://%s/?t=%s", view->host, view->token);
    mg_set_websocket_handler(view->server, "/live", greet, welcome, listen, part, view);
    mg_set_request_handler(view->server, "/", serve_page, view);
    return CK_OK;
}

ck_Status ck_view_run(ck_Live **live, const ck_ViewOptions *options, void (*ready)(void *context, const char *address),
                      void *context, ck_Error *error) {
    char address[120];
    View *view = calloc(1, sizeof *view);
    float *frame = NULL;
    if (!view) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    pthread_mutex_init(&view->lock, NULL);
    pthread_cond_init(&view->woken, NULL);
    ck_Status status = ck_stage_begin(&view->stage, *live);
    view->stage.folder = options->folder;
    view->stage.plays = !options->waits;
    view->stage.real_time = options->real_time;
    view->orders = calloc(ORDERS, sizeof *view->orders);
    view->intro = ck_intro_make(*live);
    if (!status) frame = calloc(frame_numbers(view), sizeof *frame);
    if (status || !view->orders || !view->intro || !frame) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status && (!ck_token_of_port(view->token, options->port) || !ck_token_draw(view->nonce)))
        status = ck_fail(error, CK_IO, "no random numbers for a token");
    if (!status) status = make_page(view, error);
    if (!status) status = start_server(view, options->port, address, sizeof address, error);
    if (!status) {
        ready(context, address);
        run(view, frame);
    }
    if (view->server) mg_stop(view->server);
    *live = view->stage.live;
    ck_stage_end(&view->stage);
    free(view->page);
    free(view->intro);
    free(view->orders);
    free(frame);
    free(view);
    return status;
}
