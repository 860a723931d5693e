/* OpenSubdiv's tags: creases, corners, holes and the rule for boundaries. */
#include "mesh/obj/obj_data.h"

#include <string.h>

/* Tags read `t name nints/nfloats/nstrings`, then that many of each. */
static slv_result read_tag_counts(obj *o, int64_t counts[3]) {
    counts[0] = counts[1] = counts[2] = 0;
    bool good = slvi_scan_more(&o->scan);
    for (int i = 0; good && i < 3; i++) {
        good = (i == 0 || slvi_obj_take_slash(o)) && slvi_scan_int(&o->scan, &counts[i]) &&
               counts[i] >= 0 && counts[i] <= INT32_MAX;
        if (good && i && slvi_scan_at_break(&o->scan))
            break;
    }
    if (!good || !slvi_scan_at_break(&o->scan))
        return slvi_obj_fail(o, o->scan.line, "t: expected three counts such as 2/1/0");
    return SLV_OK;
}

/* `width` indices per item, and one sharpness for all items or one for each. */
static slv_result read_sharp_tag(obj *o, obj_list *l, const int64_t counts[3], int width) {
    slv_result result = SLV_OK;
    uint64_t first = l->count;
    int64_t items = counts[0] / width;
    if (counts[0] % width || items < 1 || (counts[1] != 1 && counts[1] != items))
        return slvi_obj_fail(o, o->line, "t: %lld indices do not go with %lld numbers",
                             (long long)counts[0], (long long)counts[1]);
    for (int64_t i = 0; i < items; i++) {
        obj_tag item = {-1, -1, 0, o->line};
        if ((result = slvi_obj_read_int(o, "t", &item.a)) ||
            (width == 2 && (result = slvi_obj_read_int(o, "t", &item.b))) ||
            (result = slvi_obj_append(o, l, &item, 1, sizeof item)))
            return result;
    }
    obj_tag *tags = l->items;
    for (uint64_t i = first; i < l->count; i++) {
        if (i > first && counts[1] == 1) {
            tags[i].sharpness = tags[first].sharpness;
            continue;
        }
        if ((result = slvi_obj_read_float(o, "t", &tags[i].sharpness)))
            return result;
        if (tags[i].sharpness < 0)
            return slvi_obj_fail(o, o->line, "t: negative sharpness");
    }
    return SLV_OK;
}

static slv_result read_boundary_tag(obj *o, const int64_t counts[3]) {
    static const slv_boundary rules[] = {SLV_BOUNDARY_NONE, SLV_BOUNDARY_EDGE_AND_CORNER,
                                         SLV_BOUNDARY_EDGE_ONLY};
    int32_t rule;
    if (counts[0] != 1)
        return slvi_obj_fail(o, o->line, "t interpolateboundary: expected one integer");
    slv_result result = slvi_obj_read_int(o, "t interpolateboundary", &rule);
    if (result)
        return result;
    if (rule < 0 || rule > 2)
        return slvi_obj_fail(o, o->line, "t interpolateboundary: expected 0, 1 or 2, found %d",
                             rule);
    o->boundary = rules[rule];
    return SLV_OK;
}

static slv_result read_hole_tag(obj *o, const int64_t counts[3]) {
    slv_result result = SLV_OK;
    for (int64_t i = 0; !result && i < counts[0]; i++) {
        obj_tag item = {-1, -1, 0, o->line};
        if (!(result = slvi_obj_read_int(o, "t hole", &item.a)))
            result = slvi_obj_append(o, &o->holes, &item, 1, sizeof item);
    }
    return result;
}

slv_result slvi_obj_read_tag(obj *o) {
    const char *word;
    int64_t counts[3];
    if (!slvi_scan_more(&o->scan))
        return slvi_obj_fail(o, o->line, "t: expected the name of a tag");
    size_t length = slvi_scan_word(&o->scan, &word);
    slv_result result = read_tag_counts(o, counts);
    if (result)
        return result;
    bool crease = slvi_obj_word_is(word, length, "crease");
    int64_t unread = counts[2];
    if (crease || slvi_obj_word_is(word, length, "corner")) {
        result = read_sharp_tag(o, crease ? &o->creases : &o->corners, counts, crease ? 2 : 1);
    } else if (slvi_obj_word_is(word, length, "interpolateboundary")) {
        result = read_boundary_tag(o, counts);
        unread += counts[1];
    } else if (slvi_obj_word_is(word, length, "hole")) {
        result = read_hole_tag(o, counts);
        unread += counts[1];
    } else {
        slvi_obj_tally(&o->other_tags, o->line, word, length);
        unread += counts[0] + counts[1];
    }
    for (; !result && unread > 0 && slvi_obj_more(o); unread--)
        slvi_scan_word(&o->scan, &word);
    return result ? result : slvi_obj_end(o, "t", 0);
}
