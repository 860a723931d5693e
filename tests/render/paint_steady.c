/* What a dab allocates once a stroke goes on: from the dab on a layer to what the GPU holds, by
 * each strategy. Counted in the environment's hooks; what drivers do is their own. */
#include "kit/count_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/document.h>
#include <selvage/gl_live.h>

enum { SIDE = 10, FACES = SIDE * SIDE, PLACES = 6 };

static slv_mesh *make_mesh(const slv_env *env) {
    static float positions[3 * (SIDE + 1) * (SIDE + 1)];
    static int32_t sizes[FACES], verts[4 * FACES];
    const slv_mesh_view view = {.nverts = (SIDE + 1) * (SIDE + 1),
                                .positions = positions,
                                .npolys = FACES,
                                .poly_sizes = sizes,
                                .poly_verts = verts};
    slv_mesh *mesh = NULL;
    for (int32_t i = 0; i < (SIDE + 1) * (SIDE + 1); i++) {
        positions[3 * i] = (float)(i % (SIDE + 1));
        positions[3 * i + 1] = (float)(i / (SIDE + 1));
    }
    for (int32_t i = 0; i < FACES; i++) {
        int32_t a = i / SIDE * (SIDE + 1) + i % SIDE;
        const int32_t quad[4] = {a, a + 1, a + SIDE + 2, a + SIDE + 1};
        sizes[i] = 4;
        memcpy(verts + 4 * i, quad, sizeof quad);
    }
    REQUIRE(slv_mesh_create(env, &view, &mesh) == SLV_OK);
    return mesh;
}

typedef struct scene {
    slv_env env;
    slv_gl *gl;
    slv_mesh *mesh;
    slv_paint_surface *surface;
    slv_painter *painter;
    slv_res res[FACES];
} scene;

/* A dab at one of the places, and what it shows. Returns how many items got another layer by it. */
static uint32_t put_dab(const scene *s, slv_document *document, const slv_canvas *canvas,
                        slv_gl_texture *texture, int i) {
    const slv_paint paint = {.color = {0.8f, 0.2f, (float)(i % 7) / 7}, .opacity = 0.2f};
    const slv_dab dab = {
        .at = {11 * (1 + i % PLACES) + 3, 0.3f, 0.6f}, .radius = 2, .unfold = true};
    slv_gl_update update;
    slv_patches patches;
    REQUIRE(slv_painter_cover(s->painter, s->res, &dab, &patches) == SLV_OK);
    REQUIRE(slv_painter_apply(s->painter, canvas, &patches, &paint) == SLV_OK);
    REQUIRE(slv_document_flatten(document) == SLV_OK);
    REQUIRE(slv_gl_texture_update(texture, &s->env, &update) == SLV_OK);
    return update.moved;
}

/* Returns the most that a dab allocated. */
static unsigned long count_dabs(const scene *s, const slv_strategy *strategy, slv_type type) {
    const slv_gl_texture_params params = {KIT_ONLY(strategy), .live = true};
    const slv_document_params flat = {.flat = {.nfaces = FACES,
                                               .type = type,
                                               .nchannels = 3,
                                               .alpha_channel = SLV_NO_ALPHA,
                                               .res = s->res}};
    const slv_adjacency *adjacency = slv_paint_surface_adjacency(s->surface);
    slv_document *document = NULL;
    slv_gl_texture *texture = NULL;
    slv_canvas canvas;
    uint32_t layer;
    REQUIRE(slv_document_create(&s->env, &flat, adjacency, &document) == SLV_OK);
    REQUIRE(slv_document_add_layer(document, NULL, &layer) == SLV_OK);
    REQUIRE(slv_document_add_layer(document, NULL, &layer) == SLV_OK);
    REQUIRE(slv_document_canvas(document, layer, false, &canvas) == SLV_OK);
    REQUIRE(slv_document_flatten(document) == SLV_OK);
    REQUIRE(slv_gl_texture_create(s->gl, &s->env, slv_document_texture(document), adjacency,
                                  &params, &texture) == SLV_OK);
    REQUIRE(slv_document_begin(document, "stroke") == SLV_OK);
    int i = 0;
    for (; i < 3 * PLACES; i++)
        put_dab(s, document, &canvas, texture, i);
    unsigned long most = 0, steady = 0;
    for (; i < 6 * PLACES; i++) {
        unsigned long before = atomic_load(&allocations);
        if (put_dab(s, document, &canvas, texture, i)) /* a layer of another size or type is one */
            continue;
        before = atomic_load(&allocations) - before;
        most = before > most ? before : most;
        steady++;
    }
    CHECK(steady > 0);
    REQUIRE(slv_document_end(document) == SLV_OK);
    slv_gl_texture_destroy(texture);
    slv_document_destroy(document);
    return most;
}

int main(void) {
    static const slv_type types[] = {SLV_TYPE_U8, SLV_TYPE_HALF};
    static scene s = {
        .env = {.allocate = count_allocation, .release = count_release, .threads = 1}};
    REQUIRE(slv_gl_create(&s.env, SLV_GL_AUTO, &s.gl) == SLV_OK);
    s.mesh = make_mesh(&s.env);
    REQUIRE(slv_paint_surface_create(&s.env, s.mesh, NULL, &s.surface) == SLV_OK);
    REQUIRE(slv_painter_create(&s.env, s.surface, &s.painter) == SLV_OK);
    for (int mixed = 0; mixed < 2; mixed++) {
        for (int f = 0; f < FACES; f++)
            s.res[f] =
                mixed ? (slv_res){(int8_t)(3 + f % 2), (int8_t)(3 + f % 3)} : (slv_res){4, 4};
        for (uint32_t k = 0; k < 2 * slv_strategy_count(); k++) {
            const slv_strategy *strategy = slv_strategy_at(k / 2);
            unsigned long most = count_dabs(&s, strategy, types[k % 2]);
            const char *form = strategy->form()->name;
            /* these two make their items anew in memory of each time, however many there are */
            unsigned long bar = !strcmp(form, "edge-aligned") ? 1 : !strcmp(form, "htex") ? 4 : 0;
            CHECK_MSG(most <= bar, "%s%s, %s: %lu allocations a dab", strategy->name,
                      mixed ? ", mixed resolutions" : "", slv_type_name(types[k % 2]), most);
        }
    }
    slv_painter_destroy(s.painter);
    slv_paint_surface_destroy(s.surface);
    slv_mesh_destroy(s.mesh);
    slv_gl_destroy(s.gl);
    return test_end();
}
