#include "files.h"
#include "recording.h"
#include "scene.h"

#include <csv.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// A column's meaning: a component of a particle's state, or of the particle that its row is of.
typedef enum Component { X, Y, Z, VX, VY, VZ, TIME, PARTICLE, LEFT_ALONE } Component;
static const char *const component_names[] = {"x", "y", "z", "vx", "vy", "vz", "time_s", "particle"};

typedef struct Column {
    Component component;
    int particle; // −1: that of the row
} Column;

typedef struct Reader {
    ck_Recording *recording;
    const ck_Model *model;
    Column *columns;
    int column_count, column_capacity;
    int line, column;
    bool is_wide;
    double time, particle;
    ck_RecordedPoint *row; // [row_points] of the row that is read
    int row_points;
    ck_Status status;
    ck_Error *error;
} Reader;

static ck_Status add_point(ck_Recording *recording, const ck_RecordedPoint *point, ck_Error *error) {
    if (recording->point_count == recording->capacity) {
        int capacity = recording->capacity ? 2 * recording->capacity : 1024;
        ck_RecordedPoint *more = realloc(recording->points, sizeof *more * (size_t)capacity);
        if (!more) return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", recording->path);
        recording->points = more;
        recording->capacity = capacity;
    }
    recording->points[recording->point_count++] = *point;
    return CK_OK;
}

// What a column's name says: time_s, particle, x or, of particle 12, x12.
static Column column_of(const char *name) {
    for (int i = X; i < LEFT_ALONE; i++) {
        size_t length = strlen(component_names[i]);
        if (!strcmp(name, component_names[i])) return (Column){(Component)i, -1};
        char *end;
        if (i >= TIME || strncmp(name, component_names[i], length) || name[length] < '0' || name[length] > '9')
            continue;
        long particle = strtol(name + length, &end, 10);
        if (!*end && particle >= 0 && particle < CK_SCENE_MAX_PARTICLES) return (Column){(Component)i, (int)particle};
    }
    return (Column){LEFT_ALONE, -1};
}

static int count_columns(const Reader *reader, Component component, int particle) {
    int count = 0;
    for (int i = 0; i < reader->column_count; i++)
        count += reader->columns[i].component == component && reader->columns[i].particle == particle;
    return count;
}

static ck_Status fail_column(const Reader *reader, const char *name, int particle, int count) {
    char number[16] = "";
    if (particle >= 0) snprintf(number, sizeof number, "%d", particle);
    return ck_fail(reader->error, CK_BAD_INPUT,
                   "%s:1: the header has %s column %s%s; it must have time_s, particle, x, y and z, or time_s and x0, "
                   "y0, z0, x1 ... of every particle",
                   reader->recording->path, count ? "twice the" : "no", name, number);
}

// A row of a frame must have every particle: whatever is missing would be found at each row only.
static ck_Status check_header(Reader *reader) {
    int widest = -1;
    for (int i = 0; i < reader->column_count; i++)
        if (reader->columns[i].particle > widest) widest = reader->columns[i].particle;
    reader->is_wide = widest >= 0;
    reader->row_points = reader->is_wide ? widest + 1 : 1;
    if (reader->row_points > reader->model->particle_count)
        return ck_fail(reader->error, CK_BAD_INPUT, "%s:1: there is a particle %d; the scene has 0 to %d",
                       reader->recording->path, widest, reader->model->particle_count - 1);
    int speeds = 0;
    for (int i = 0; i < reader->column_count; i++)
        speeds += reader->columns[i].component >= VX && reader->columns[i].component <= VZ;
    reader->recording->has_velocity = speeds > 0;
    for (int component = X; component <= PARTICLE; component++) {
        if (component == PARTICLE && reader->is_wide) continue;
        if (component >= VX && component <= VZ && !speeds) continue;
        bool is_of_row = component >= TIME || !reader->is_wide;
        for (int particle = 0; particle < (is_of_row ? 1 : reader->row_points); particle++) {
            int of = is_of_row ? -1 : particle, count = count_columns(reader, (Component)component, of);
            if (count != 1) return fail_column(reader, component_names[component], of, count);
        }
    }
    reader->row = calloc((size_t)reader->row_points, sizeof *reader->row);
    return reader->row ? CK_OK : ck_fail(reader->error, CK_NO_MEMORY, "%s: out of memory", reader->recording->path);
}

static ck_Status take_name(Reader *reader, const char *name) {
    if (reader->column_count == reader->column_capacity) {
        int capacity = reader->column_capacity ? 2 * reader->column_capacity : 16;
        Column *more = realloc(reader->columns, sizeof *more * (size_t)capacity);
        if (!more) return ck_fail(reader->error, CK_NO_MEMORY, "%s: out of memory", reader->recording->path);
        reader->columns = more;
        reader->column_capacity = capacity;
    }
    reader->columns[reader->column_count++] = column_of(name);
    return CK_OK;
}

static ck_Status take_number(Reader *reader, const char *text) {
    const Column *column = &reader->columns[reader->column];
    char *end;
    double number = strtod(text, &end);
    bool is_number = end != text && !*end;
    if (column->component == LEFT_ALONE) return CK_OK;
    if (!is_number || (column->component >= TIME && !isfinite(number)))
        return ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: column %d (%s): must be a number, not '%.60s'",
                       reader->recording->path, reader->line, reader->column + 1, component_names[column->component],
                       text);
    ck_RecordedPoint *point = &reader->row[column->particle > 0 ? column->particle : 0];
    if (column->component == TIME) reader->time = number;
    if (column->component == PARTICLE) reader->particle = number;
    if (column->component <= Z) point->at[column->component] = number;
    if (column->component >= VX && column->component <= VZ) point->velocity[column->component - VX] = number;
    return CK_OK;
}

static void take_field(void *text, size_t length, void *context) {
    (void)length; // libcsv ends it with a zero
    Reader *reader = context;
    if (reader->status) return;
    if (reader->line == 1)
        reader->status = take_name(reader, text ? text : "");
    else if (reader->column < reader->column_count)
        reader->status = take_number(reader, text ? text : "");
    reader->column++;
}

static ck_Status take_row(Reader *reader) {
    const char *path = reader->recording->path;
    int most = reader->model->particle_count - 1;
    if (reader->column != reader->column_count)
        return ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: %d columns where the header has %d", path, reader->line,
                       reader->column, reader->column_count);
    if (!reader->is_wide &&
        !(reader->particle >= 0 && reader->particle <= most && floor(reader->particle) == reader->particle))
        return ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: particle is %g; the scene has 0 to %d", path, reader->line,
                       reader->particle, most);
    // times are often printed in a few digits
    if (!(reader->time >= 0 && reader->time <= reader->model->duration + 0.5 * reader->model->step))
        return ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: time_s is %g; the scene goes from 0 to %g s", path,
                       reader->line, reader->time, reader->model->duration);
    for (int i = 0; i < reader->row_points; i++) {
        reader->row[i].time = reader->time;
        reader->row[i].particle = reader->is_wide ? i : (int)reader->particle;
        reader->row[i].line = reader->line;
        ck_Status status = add_point(reader->recording, &reader->row[i], reader->error);
        if (status) return status;
    }
    return CK_OK;
}

static void end_row(int end, void *context) {
    (void)end;
    Reader *reader = context;
    if (!reader->status) reader->status = reader->line == 1 ? check_header(reader) : take_row(reader);
    reader->column = 0;
}

static bool has_return(const char *line, size_t length) {
    const char *found = memchr(line, '\r', length);
    return found && found != line + length - 2;
}

// Line by line, so that an error knows where it is.
static ck_Status read_csv(Reader *reader, const char *bytes, size_t size) {
    struct csv_parser parser;
    if (csv_init(&parser, CSV_STRICT | CSV_STRICT_FINI | CSV_APPEND_NULL))
        return ck_fail(reader->error, CK_NO_MEMORY, "%s: out of memory", reader->recording->path);
    for (size_t at = ck_text_mark(bytes, size); at < size && !reader->status;) {
        const char *newline = memchr(bytes + at, '\n', size - at);
        size_t length = newline ? (size_t)(newline - bytes) + 1 - at : size - at;
        reader->line++;
        if (memchr(bytes + at, 0, length))
            reader->status = ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: there is a zero byte",
                                     reader->recording->path, reader->line);
        // one before the newline is how some systems end a line; another would end a row within it
        else if (has_return(bytes + at, length))
            reader->status = ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: there is a carriage return within the line",
                                     reader->recording->path, reader->line);
        else if (csv_parse(&parser, bytes + at, length, take_field, end_row, reader) != length)
            reader->status = ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: column %d: %s", reader->recording->path,
                                     reader->line, reader->column + 1, csv_strerror(csv_error(&parser)));
        at += length;
    }
    // the last line may have no end
    if (!reader->status && csv_fini(&parser, take_field, end_row, reader))
        reader->status = ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: a quoted field has no end",
                                 reader->recording->path, reader->line);
    csv_free(&parser);
    return reader->status;
}

// The number at a place of an array of NumPy's.
static double number_at(const char *data, size_t index, bool is_float) {
    float one;
    double number;
    if (!is_float) {
        memcpy(&number, data + index * sizeof number, sizeof number);
        return number;
    }
    memcpy(&one, data + index * sizeof one, sizeof one);
    return (double)one;
}

// NumPy's header: a magic word, a version, a length, and a Python dictionary in a fixed form.
// Source: NEP 1, A simple file format for NumPy arrays.
static ck_Status read_npy(Reader *reader, const char *bytes, size_t size, double interval) {
    ck_Recording *recording = reader->recording;
    const unsigned char *raw = (const unsigned char *)bytes;
    const int particles = reader->model->particle_count;
    size_t lengths = size > 6 && raw[6] > 1 ? 4 : 2, start = 8 + lengths, length = 0;
    for (size_t i = 0; i < lengths && start <= size; i++) length |= (size_t)raw[8 + i] << (8 * i);
    const char *shape = NULL, *order = NULL;
    bool is_float = false, is_double = false;
    char header[512] = "";
    if (start <= size && length < sizeof header && start + length <= size) {
        memcpy(header, bytes + start, length);
        shape = strstr(header, "'shape': (");
        order = strstr(header, "'fortran_order': False");
        is_float = strstr(header, "'<f4'");
        is_double = strstr(header, "'<f8'");
    }
    long frames = 0, of = 0, axes = 0;
    int used = 0;
    if (!shape || !order || is_float == is_double ||
        sscanf(shape, "'shape': (%ld, %ld, %ld)%n", &frames, &of, &axes, &used) != 3 || !used || axes != 3 ||
        frames < 1 || frames > 100000000 || of != particles)
        return ck_fail(reader->error, CK_BAD_INPUT,
                       "%s: must be an array of float32 or float64 in C order, of shape (frames, %d, 3), not %.80s",
                       recording->path, particles, shape ? shape + 9 : "a file of something else");
    size_t wanted = (size_t)frames * (size_t)particles * 3 * (is_float ? sizeof(float) : sizeof(double));
    if (size - start - length != wanted)
        return ck_fail(reader->error, CK_BAD_INPUT, "%s: holds %zu bytes of numbers where its shape needs %zu",
                       recording->path, size - start - length, wanted);
    double step = interval > 0 ? interval : reader->model->step;
    for (size_t i = 0; i < (size_t)frames * (size_t)particles; i++) {
        size_t frame = i / (size_t)particles;
        ck_RecordedPoint point = {
            .time = (double)frame * step, .particle = (int)(i % (size_t)particles), .line = (int)frame + 1};
        for (size_t axis = 0; axis < 3; axis++)
            point.at[axis] = number_at(bytes + start + length, 3 * i + axis, is_float);
        if (point.time > reader->model->duration + 0.5 * reader->model->step)
            return ck_fail(reader->error, CK_BAD_INPUT,
                           "%s: %ld frames, %g s apart, go beyond the scene's %g s; --interval says how far apart",
                           recording->path, frames, step, reader->model->duration);
        ck_Status status = add_point(recording, &point, reader->error);
        if (status) return status;
    }
    return CK_OK;
}

ck_Status ck_recording_read(ck_Recording *recording, const char *path, const ck_Model *model, double interval,
                            ck_Error *error) {
    *recording = (ck_Recording){.path = path};
    Reader reader = {.recording = recording, .model = model, .error = error};
    char *bytes = NULL;
    size_t size;
    ck_Status status = ck_file_read(&bytes, &size, path, error);
    if (!status)
        status = size > 6 && !memcmp(bytes, "\x93NUMPY", 6) ? read_npy(&reader, bytes, size, interval)
                                                            : read_csv(&reader, bytes, size);
    if (!status && !recording->point_count) status = ck_fail(error, CK_BAD_INPUT, "%s: holds no positions", path);
    free(bytes);
    free(reader.columns);
    free(reader.row);
    return status;
}

void ck_recording_free(ck_Recording *recording) {
    free(recording->points);
    *recording = (ck_Recording){0};
}
