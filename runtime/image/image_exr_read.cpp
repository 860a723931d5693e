/* OpenEXR images read through OpenEXR's C++ library: its C library does not know DWAA and DWAB, and
 * takes B44 chunks that are stored plain for packed ones. C++ behind image_file.h: nothing thrown
 * leaves this file. */
#include <algorithm>
#include <cstring>
#include <new>
#include <set>
#include <string>
#include <vector>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>

extern "C" {
#include "image/image_file.h"
}

namespace {

using Imath::Box2i;

/* The bytes of a whole file. */
class Bytes : public Imf::IStream {
  public:
    Bytes(const char *name, const void *bytes, size_t size)
        : Imf::IStream(name), bytes_(static_cast<const char *>(bytes)), size_(size) {
    }

    bool read(char *to, int count) override {
        if (count < 0 || at_ > size_ || static_cast<uint64_t>(count) > size_ - at_)
            throw Iex::InputExc("the file ends too early");
        std::memcpy(to, bytes_ + at_, static_cast<size_t>(count));
        at_ += static_cast<uint64_t>(count);
        return at_ < size_;
    }
    uint64_t tellg() override {
        return at_;
    }
    void seekg(uint64_t at) override {
        at_ = at;
    }

  private:
    const char *bytes_;
    uint64_t size_, at_ = 0;
};

/* What is read: a part of the file, a layer in it (with its dot; mostly none), and its channels in
 * the image's order. */
struct Choice {
    int part = 0;
    std::string layer;
    std::vector<std::string> names;
};

struct Reading {
    const slv_env *env;
    const char *path;
    uint64_t file_size;
    slv_image *image;
};

/* Y is luminance where it stands alone or with A, but one of several coordinates or vectors'
 * components where its layer has other letters beside it (X and Z, or a colour's). */
bool has_other_letters(const Imf::ChannelList &list, const std::string &layer) {
    for (auto i = list.begin(); i != list.end(); ++i) {
        std::string name = i.name();
        if (name.size() == layer.size() + 1 && name.compare(0, layer.size(), layer) == 0 &&
            name.back() != 'Y' && name.back() != 'A')
            return true;
    }
    return false;
}

bool pick(const Imf::ChannelList &list, int part, const std::string &layer, Choice &out) {
    for (const char *kind : {"RGBA", "RGB", "YA", "Y"}) {
        out = {part, layer, {}};
        for (const char *letter = kind; *letter; letter++)
            if (list.findChannel(layer + *letter))
                out.names.push_back(layer + *letter);
        if (out.names.size() == std::strlen(kind))
            return kind[0] != 'Y' || !has_other_letters(list, layer);
    }
    return false;
}

std::string part_name(const Imf::MultiPartInputFile &file, int part) {
    const Imf::Header &header = file.header(part);
    return header.hasName() ? header.name() : std::to_string(part);
}

void append_name(std::string &list, const std::string &name) {
    constexpr size_t kLongest = 200;
    if (list.size() > kLongest)
        return;
    list += (list.empty() ? "" : ", ") + name;
    if (list.size() > kLongest)
        list += ", ...";
}

/* The first part that has an image of its own decides; else the only layer that is one. */
slv_result choose(const Reading &r, const Imf::MultiPartInputFile &file, Choice &out) {
    std::string channels, layers;
    int nlayers = 0;
    for (int part = 0; part < file.parts(); part++)
        if (pick(file.header(part).channels(), part, "", out))
            return SLV_OK;
    for (int part = 0; part < file.parts(); part++) {
        const Imf::ChannelList &list = file.header(part).channels();
        std::string prefix = file.parts() > 1 ? part_name(file, part) + "/" : "";
        std::set<std::string> seen;
        Choice layer;
        for (auto i = list.begin(); i != list.end(); ++i) {
            std::string name = i.name(), stem = name.substr(0, name.rfind('.') + 1);
            append_name(channels, prefix + name);
            if (!seen.insert(stem).second || !pick(list, part, stem, layer))
                continue;
            append_name(layers, prefix + stem.substr(0, stem.size() - 1));
            out = layer;
            nlayers++;
        }
    }
    if (nlayers == 1) {
        slvi_logf(r.env, SLV_LOG_INFO, "%s: the layer %s is read", r.path, layers.c_str());
        return SLV_OK;
    }
    if (nlayers > 1)
        return slvi_fail(r.env, SLV_ERROR_UNSUPPORTED,
                         "%s: has %d layers (%s), and none of them without a name, which would be "
                         "read",
                         r.path, nlayers, layers.c_str());
    return slvi_fail(r.env, SLV_ERROR_UNSUPPORTED,
                     "%s: an EXR must have channels R G B (A), or Y (A) and no X or Z; this has %s",
                     r.path, channels.empty() ? "none" : channels.c_str());
}

/* What of the kinds of OpenEXR files cannot become an image is refused by name. */
slv_result check_kind(const Reading &r, const Imf::MultiPartInputFile &file, const Choice &choice) {
    const Imf::Header &header = file.header(choice.part);
    const Imf::ChannelList &list = header.channels();
    const char *refused = nullptr;
    std::string type = header.hasType() ? header.type() : Imf::SCANLINEIMAGE;
    if (Imf::isDeepData(type))
        refused = "has deep pixels (many samples each), which are not read; flatten it first";
    else if (type != Imf::SCANLINEIMAGE && type != Imf::TILEDIMAGE)
        refused = "is of a kind that is not known";
    else if (list.findChannel(choice.layer + "RY") || list.findChannel(choice.layer + "BY"))
        refused = choice.names[0] == choice.layer + "Y"
                      ? "has luminance and chroma (Y RY BY), which are not read; save it as RGB"
                      : nullptr;
    if (refused)
        return slvi_fail(r.env, SLV_ERROR_UNSUPPORTED, "%s: %s", r.path, refused);
    for (const std::string &name : choice.names) {
        const Imf::Channel &channel = list[name.c_str()];
        if (channel.xSampling != 1 || channel.ySampling != 1)
            return slvi_fail(r.env, SLV_ERROR_UNSUPPORTED,
                             "%s: channel %s is subsampled (%d x %d), which is not read", r.path,
                             name.c_str(), channel.xSampling, channel.ySampling);
        if (channel.type != Imf::HALF && channel.type != Imf::FLOAT)
            return slvi_fail(r.env, SLV_ERROR_UNSUPPORTED,
                             "%s: channel %s holds integers (uint), expected half or float", r.path,
                             name.c_str());
    }
    return SLV_OK;
}

uint64_t lines_per_chunk(Imf::Compression compression) {
    switch (compression) {
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
        return 16;
    case Imf::PIZ_COMPRESSION:
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION:
        return 32;
    case Imf::DWAB_COMPRESSION:
        return 256;
    default:
        return 1;
    }
}

/* Before anything is allocated for the pixels: windows that an image can have, chunks within the
 * limit, and no more pixels than a file of this size can hold. */
slv_result check_sizes(const Reading &r, const Imf::Header &header) {
    const Box2i &data = header.dataWindow(), &shown = header.displayWindow();
    int64_t sides[4] = {int64_t(shown.max.x) - shown.min.x + 1,
                        int64_t(shown.max.y) - shown.min.y + 1,
                        int64_t(data.max.x) - data.min.x + 1, int64_t(data.max.y) - data.min.y + 1};
    for (int i = 0; i < 4; i += 2)
        if (sides[i] < 1 || sides[i + 1] < 1 || sides[i] > IMAGE_MAX_SIDE ||
            sides[i + 1] > IMAGE_MAX_SIDE)
            return slvi_fail(r.env, SLV_ERROR_LIMIT, "%s: its %s window is %lld x %lld", r.path,
                             i ? "data" : "display", static_cast<long long>(sides[i]),
                             static_cast<long long>(sides[i + 1]));
    if (!data.intersects(shown))
        return slvi_fail(r.env, SLV_ERROR_UNSUPPORTED,
                         "%s: its data window (%d,%d to %d,%d) lies outside of the display window "
                         "(%d,%d to %d,%d)",
                         r.path, data.min.x, data.min.y, data.max.x, data.max.y, shown.min.x,
                         shown.min.y, shown.max.x, shown.max.y);
    uint64_t pixel = 0, width = uint64_t(sides[2]), height = uint64_t(sides[3]);
    for (auto i = header.channels().begin(); i != header.channels().end(); ++i)
        pixel += i.channel().type == Imf::HALF ? 2 : 4;
    uint64_t chunk = width * lines_per_chunk(header.compression());
    if (header.hasTileDescription()) {
        uint64_t x = header.tileDescription().xSize, y = header.tileDescription().ySize;
        if (x < 1 || y < 1 || x > IMAGE_MAX_SIDE || y > IMAGE_MAX_SIDE)
            return slvi_fail(r.env, SLV_ERROR_LIMIT, "%s: its tiles are %llu x %llu", r.path,
                             static_cast<unsigned long long>(x),
                             static_cast<unsigned long long>(y));
        chunk = (std::max(x, width) + x) * y; /* a row of them is in memory as well */
    }
    uint64_t most = slvi_env_or_default(r.env).max_bytes;
    if (chunk > most / std::max<uint64_t>(pixel, sizeof(float) * 4))
        return slvi_fail(r.env, SLV_ERROR_LIMIT, "%s: its chunks are larger than %llu bytes",
                         r.path, static_cast<unsigned long long>(most));
    /* A block of 64 pixels becomes a few bits at best with DWA, 1032 bytes one with deflate, a run
     * of 128 two with RLE. */
    bool dwa = header.compression() == Imf::DWAA_COMPRESSION ||
               header.compression() == Imf::DWAB_COMPRESSION;
    if (width * height / (dwa ? 1 << 18 : 1 << 12) > r.file_size)
        return slvi_fail(
            r.env, SLV_ERROR_FORMAT, "%s: claims %llu x %llu pixels in a file of %llu bytes",
            r.path, static_cast<unsigned long long>(width), static_cast<unsigned long long>(height),
            static_cast<unsigned long long>(r.file_size));
    return SLV_OK;
}

/* The image is the display window: what the data window has beyond it is left out, and where it has
 * nothing, zeros stay. */
slv_result read_pixels(const Reading &r, Imf::MultiPartInputFile &file, const Choice &choice) {
    const Imf::Header &header = file.header(choice.part);
    const Box2i data = header.dataWindow(), shown = header.displayWindow();
    size_t n = choice.names.size(), stride = n * sizeof(float);
    slv_result result =
        slv_image_create(r.env, uint32_t(int64_t(shown.max.x) - shown.min.x + 1),
                         uint32_t(int64_t(shown.max.y) - shown.min.y + 1), uint32_t(n), r.image);
    if (result)
        return result;
    r.image->type = SLV_TYPE_HALF;
    Imf::InputPart part(file, choice.part);
    Imf::FrameBuffer frame;
    std::vector<float> row(n * size_t(int64_t(data.max.x) - data.min.x + 1));
    for (size_t c = 0; c < n; c++) {
        /* OpenEXR adds x times the stride to where x = 0 would be */
        intptr_t origin =
            reinterpret_cast<intptr_t>(row.data() + c) - intptr_t(stride) * data.min.x;
        if (header.channels()[choice.names[c].c_str()].type == Imf::FLOAT)
            r.image->type = SLV_TYPE_FLOAT;
        frame.insert(choice.names[c],
                     Imf::Slice(Imf::FLOAT, reinterpret_cast<char *>(origin), stride, 0));
    }
    part.setFrameBuffer(frame);
    int left = std::max(data.min.x, shown.min.x), right = std::min(data.max.x, shown.max.x);
    int top = std::max(data.min.y, shown.min.y), bottom = std::min(data.max.y, shown.max.y);
    for (int y = top; y <= bottom; y++) {
        part.readPixels(y);
        size_t at =
            size_t(y - int64_t(shown.min.y)) * r.image->width + size_t(left - int64_t(shown.min.x));
        std::memcpy(r.image->pixels + at * n, row.data() + size_t(left - int64_t(data.min.x)) * n,
                    size_t(right - int64_t(left) + 1) * stride);
    }
    return SLV_OK;
}

slv_result read_file(const Reading &r, const void *bytes) {
    Bytes stream(r.path, bytes, r.file_size);
    Imf::MultiPartInputFile file(stream, 0, false);
    Choice choice;
    slv_result result;
    if ((result = choose(r, file, choice)) || (result = check_kind(r, file, choice)) ||
        (result = check_sizes(r, file.header(choice.part))))
        return result;
    return read_pixels(r, file, choice);
}

} // namespace

/* OpenEXR allocates values of types that it does not know as large as they claim to be, so none may
 * claim more than the file holds. Of what is cut short OpenEXR tells. */
static bool attributes_fit(const unsigned char *bytes, size_t size) {
    bool many_parts = size > 5 && (bytes[5] & 0x10);
    size_t at = 8, header;
    do {
        header = at;
        while (at < size && bytes[at]) {
            for (int text = 0; text < 2; text++) { /* name and type */
                const void *end = at < size ? std::memchr(bytes + at, 0, size - at) : nullptr;
                if (!end)
                    return true;
                at = static_cast<size_t>(static_cast<const unsigned char *>(end) - bytes) + 1;
            }
            if (size - at < 4)
                return true;
            uint32_t claimed = bytes[at] | static_cast<uint32_t>(bytes[at + 1]) << 8 |
                               static_cast<uint32_t>(bytes[at + 2]) << 16 |
                               static_cast<uint32_t>(bytes[at + 3]) << 24;
            at += 4;
            if (claimed > size - at)
                return false;
            at += claimed;
        }
        at++;
    } while (many_parts && at < size && at > header + 1);
    return true;
}

slv_result slvi_image_exr_decode(const slv_env *env, const char *path, const void *bytes,
                                 size_t size, slv_image *out) {
    slv_result result;
    if (!attributes_fit(static_cast<const unsigned char *>(bytes), size))
        return slvi_fail(env, SLV_ERROR_FORMAT, "%s: an attribute claims more than the file holds",
                         path);
    try {
        result = read_file({env, path, size, out}, bytes);
    } catch (const std::bad_alloc &) {
        result = slvi_fail(env, SLV_ERROR_MEMORY, "%s: no memory to read it", path);
    } catch (const std::exception &error) {
        char what[256]; /* a string of C++'s might find no memory here */
        std::strncpy(what, error.what(), sizeof what - 1);
        what[sizeof what - 1] = 0;
        for (char *c = what; *c; c++)
            *c = static_cast<unsigned char>(*c) < ' ' ? ' ' : *c;
        result = slvi_fail(env, SLV_ERROR_FORMAT, "%s: %s", path, what);
    } catch (...) {
        result = slvi_fail(env, SLV_ERROR_FORMAT, "%s: cannot be read", path);
    }
    if (result)
        slv_image_free(out);
    return result;
}
