/* Random meshes as OBJ files in every legal spelling of numbers, indices, blanks, line ends and
 * joined lines, read by the library and by a small reader of this test's own. */
#include "kit/test.h"

#include <selvage/mesh.h>

#include <ctype.h>
#include <stdarg.h>

enum { MOST_VERTS = 40, MOST_POLYS = 30, MOST_SIDES = 7, ROOM = 1 << 17 };

static char text[ROOM];
static size_t used;
static uint64_t random_state = 29;
static const char *line_end;
static uint32_t backslashes;

static uint32_t dice(uint32_t sides) {
    return test_random(&random_state) % sides;
}

static void put(const char *format, ...) __attribute__((format(printf, 1, 2)));
static void put(const char *format, ...) {
    va_list args;
    va_start(args, format);
    int size = vsnprintf(text + used, ROOM - used, format, args);
    va_end(args);
    REQUIRE(size >= 0 && used + (size_t)size < ROOM);
    used += (size_t)size;
}

static void blank(void) {
    static const char *const blanks[] = {" ", " ", " ", "\t", "  ", " \t "};
    put("%s", blanks[dice(6)]);
    if (dice(12) == 0)
        put("\\%s%s", line_end, dice(2) ? " " : "");
}

static void end_line(void) {
    static const char *const between[] = {"# f 1 2 3", "",       "usemtl a b",
                                          "s off",     "vp 0.5", "   # v"};
    static const char *const tails[] = {" \t", " # 1 2 3", "\t#"};
    put("%s%s", dice(8) ? "" : tails[dice(3)], line_end);
    if (dice(5) == 0)
        put("%s%s", between[dice(6)], line_end);
}

static void put_number(void) {
    static const char *const formats[] = {"%.9g", "%+.7f", "%e", "%.3E", "%.0f.", "%.0f", "%.12f"};
    double value = ((double)dice(2000001) - 1e6) / (dice(2) ? 1e6 : 1e3);
    char number[64];
    snprintf(number, sizeof number, formats[dice(7)], value);
    bool short_form = dice(4) == 0 && number[0] == '0' && number[1] == '.' && number[2];
    put("%s", number + short_form);
}

static void put_values(const char *word, uint32_t count) {
    put("%s%s", dice(8) ? "" : "  ", word);
    for (uint32_t i = 0; i < count; i++) {
        blank();
        put_number();
    }
    if (dice(30) == 0) { /* joins nothing, where what follows is a statement */
        put("\\%s", line_end);
        backslashes++;
    } else
        end_line();
}

static void put_index(uint32_t zero_based, uint32_t so_far) {
    if (zero_based < so_far && dice(2))
        put("%d", (int)zero_based - (int)so_far);
    else
        put("%u", zero_based + 1);
}

static void put_face(const uint32_t there[3], const uint32_t so_far[3]) {
    uint32_t sides = 3 + dice(MOST_SIDES - 2), first = dice(there[0]);
    uint32_t form = dice(4);
    if (sides > there[0])
        sides = there[0];
    put("%s", "f");
    for (uint32_t i = 0; i < sides; i++) {
        blank();
        put_index((first + i) % there[0], so_far[0]);
        if (form == 0)
            continue;
        put("/");
        if (form != 2)
            put_index(dice(there[1]), so_far[1]);
        if (form != 1) {
            put("/");
            put_index(dice(there[2]), so_far[2]);
        }
    }
    end_line();
}

static void write_file(void) {
    static const char *const ends[] = {"\n", "\r\n", "\r"};
    const uint32_t there[3] = {3 + dice(MOST_VERTS - 2), 1 + dice(9), 1 + dice(9)};
    uint32_t so_far[3] = {0}, polys = 1 + dice(MOST_POLYS);
    used = 0;
    line_end = ends[dice(3)];
    put("%s", dice(4) ? "" : "\xEF\xBB\xBF");
    if (dice(2))
        put("# made at random%s", line_end);
    while (polys || so_far[0] < there[0] || so_far[1] < there[1] || so_far[2] < there[2]) {
        uint32_t kind = dice(4);
        if (kind == 3 && polys) {
            put_face(there, so_far);
            polys--;
        } else if (kind < 3 && so_far[kind] < there[kind]) {
            static const char *const words[] = {"v", "vt", "vn"};
            static const uint32_t counts[] = {3, 2, 3};
            put_values(words[kind], counts[kind] + (kind < 2 && dice(5) == 0));
            so_far[kind]++;
        }
    }
    if (dice(3) == 0) { /* the last line may lack its end, or be joined to nothing */
        while (used && (isspace((unsigned char)text[used - 1]) || text[used - 1] == '\\'))
            used--;
        put("%s", dice(2) ? "\\" : "");
    }
}

/* What the small reader found. */
static struct {
    uint32_t counts[3], npolys, ncorners;
    float values[3][3 * MOST_VERTS];
    int32_t sizes[MOST_POLYS], corners[3][MOST_POLYS * MOST_SIDES];
} found;

static void read_corner(const char *word) {
    for (int k = 0; k < 3; k++) {
        char *end;
        long index = strtol(word, &end, 10);
        found.corners[k][found.ncorners] =
            end == word ? -1 : (int32_t)(index > 0 ? index - 1 : found.counts[k] + index);
        word = *end == '/' ? end + 1 : end;
    }
    found.ncorners++;
}

static void read_line(char *line) {
    static const char *const words[] = {"v", "vt", "vn"};
    static const uint32_t counts[] = {3, 2, 3};
    line[strcspn(line, "#")] = 0;
    char *left = NULL, *word = strtok_r(line, " \t", &left);
    if (!word)
        return;
    if (strcmp(word, "f") == 0) {
        uint32_t before = found.ncorners;
        while ((word = strtok_r(NULL, " \t", &left)))
            read_corner(word);
        found.sizes[found.npolys++] = (int32_t)(found.ncorners - before);
    }
    for (int k = 0; word && k < 3; k++)
        if (strcmp(word, words[k]) == 0) {
            for (uint32_t i = 0; i < counts[k]; i++)
                found.values[k][counts[k] * found.counts[k] + i] =
                    strtof(strtok_r(NULL, " \t", &left), NULL);
            found.counts[k]++;
            break;
        }
}

static bool begins_statement(const char *at, const char *end) {
    static const char *const words[] = {"v", "vt", "vn", "f", "s", "usemtl"};
    while (at < end && (*at == ' ' || *at == '\t'))
        at++;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        size_t length = strlen(words[i]);
        if ((size_t)(end - at) > length && !memcmp(at, words[i], length) && isblank(at[length]))
            return true;
    }
    return false;
}

static void read_file(void) {
    static char copy[ROOM], line[ROOM];
    const char *at = text, *end = text + used;
    size_t length = 0, size = 0;
    memset(&found, 0, sizeof found);
    if (used >= 3 && memcmp(at, "\xEF\xBB\xBF", 3) == 0)
        at += 3;
    for (; at < end; at++) { /* every end of a line becomes one \n, and what joins lines a blank */
        bool two = *at == '\r' && at + 1 < end && at[1] == '\n';
        copy[length++] = *at == '\r' ? '\n' : *at;
        at += two;
        if (length > 1 && copy[length - 1] == '\n' && copy[length - 2] == '\\') {
            length--;
            copy[length - 1] = begins_statement(at + 1, end) ? '\n' : ' ';
        }
    }
    length -= length && copy[length - 1] == '\\';
    for (size_t i = 0; i <= length; i++)
        if (i == length || copy[i] == '\n') {
            line[size] = 0;
            read_line(line);
            size = 0;
        } else
            line[size++] = copy[i];
}

static bool same_corners(const int32_t *read, int k) {
    for (uint32_t i = 0; i < found.ncorners; i++)
        if ((read ? read[i] : -1) != found.corners[k][i])
            return false;
    return true;
}

static bool same_mesh(const slv_mesh_view *v) {
    return v->nverts == found.counts[0] && v->npolys == found.npolys &&
           v->ntexcoords == found.counts[1] && v->nnormals == found.counts[2] &&
           !memcmp(v->poly_sizes, found.sizes, found.npolys * sizeof *found.sizes) &&
           !memcmp(v->positions, found.values[0], 3 * found.counts[0] * sizeof(float)) &&
           !memcmp(v->texcoords, found.values[1], 2 * found.counts[1] * sizeof(float)) &&
           !memcmp(v->normals, found.values[2], 3 * found.counts[2] * sizeof(float)) &&
           same_corners(v->poly_verts, 0) && same_corners(v->poly_texcoords, 1) &&
           same_corners(v->poly_normals, 2);
}

int main(void) {
    uint32_t rounds = test_effort(2000), corners = 0;
    for (uint32_t round = 0; round < rounds; round++) {
        slv_env env = test_env();
        slv_mesh *mesh = NULL;
        uint64_t seed = random_state;
        write_file();
        read_file();
        slv_result result = slv_mesh_parse_obj(&env, "random.obj", text, used, &mesh);
        bool good = result == SLV_OK && same_mesh(slv_mesh_get_view(mesh));
        CHECK_MSG(good, "file %u (seed %llu): %s, %s\n%.*s", round, (unsigned long long)seed,
                  slv_result_string(result), test_last_log, (int)used, text);
        corners += found.ncorners;
        slv_mesh_destroy(mesh);
        if (!good)
            break;
    }
    CHECK(corners > rounds * 10 && backslashes > rounds / 10);
    return test_end();
}
