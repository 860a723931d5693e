/* OpenEXR files in all forms that OpenEXR's own library writes, for tests. C++ behind a C header.
 */
#include "images/exr_writer.h"

#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfDeepTiledOutputFile.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfTiledOutputFile.h>
#include <ImfTiledOutputPart.h>

namespace {

using Imath::Box2i;
using Imath::V2i;

Box2i box(const int window[4]) {
    return Box2i(V2i(window[0], window[1]), V2i(window[2], window[3]));
}

/* Planes of one window, in the file's type, that a frame buffer points into. */
struct Planes {
    std::vector<std::string> names;
    std::vector<std::vector<float>> floats;
    std::vector<std::vector<half>> halves;

    void add(const std::string &name, bool is_float, size_t count) {
        names.push_back(name);
        floats.emplace_back(is_float ? count : 0);
        halves.emplace_back(is_float ? 0 : count);
    }
    void set(size_t c, size_t i, float value) {
        if (floats[c].empty())
            halves[c][i] = half(value);
        else
            floats[c][i] = value;
    }
    Imf::FrameBuffer frame(const Box2i &window) {
        Imf::FrameBuffer out;
        for (size_t c = 0; c < names.size(); c++)
            if (floats[c].empty())
                out.insert(names[c], Imf::Slice::Make(Imf::HALF, halves[c].data(), window));
            else
                out.insert(names[c], Imf::Slice::Make(Imf::FLOAT, floats[c].data(), window));
        return out;
    }
};

size_t area(const Box2i &window) {
    return size_t(window.max.x - window.min.x + 1) * size_t(window.max.y - window.min.y + 1);
}

/* Letters beside Y would make another thing of it. */
std::string extra_name(const exr_form &form, const char *letter) {
    return std::string(form.channels[0] == 'Y' ? "extra." : "") + letter;
}

Imf::Header header_of(const exr_form &form) {
    Imf::Header header(box(form.display), box(form.data), 1, V2i(0, 0), 1,
                       Imf::LineOrder(form.line_order), Imf::Compression(form.compression));
    Imf::PixelType type = form.floats ? Imf::FLOAT : Imf::HALF;
    for (const char *letter = form.channels; *letter; letter++)
        header.channels().insert(form.layer + std::string(1, *letter), Imf::Channel(type));
    if (form.extra) {
        header.channels().insert(extra_name(form, "Z"), Imf::Channel(Imf::FLOAT));
        header.channels().insert(extra_name(form, "H"), Imf::Channel(Imf::HALF));
    }
    if (form.tile)
        header.setTileDescription(Imf::TileDescription(unsigned(form.tile), unsigned(form.tile),
                                                       Imf::LevelMode(form.levels)));
    return header;
}

Planes planes_of(const exr_form &form, const Box2i &window, const float *pixels) {
    Planes planes;
    size_t n = std::strlen(form.channels), count = area(window);
    for (size_t c = 0; c < n; c++)
        planes.add(form.layer + std::string(1, form.channels[c]), form.floats, count);
    if (form.extra) {
        planes.add(extra_name(form, "Z"), true, count);
        planes.add(extra_name(form, "H"), false, count);
    }
    for (size_t c = 0; c < planes.names.size(); c++)
        for (size_t i = 0; i < count; i++)
            planes.set(c, i, pixels && c < n ? pixels[i * n + c] : 77.0f);
    return planes;
}

/* TiledOutputFile and TiledOutputPart. */
template <class File> void write_tiles(File &file, const exr_form &form, const float *pixels) {
    for (int y = 0; y < file.numYLevels(); y++)
        for (int x = 0; x < file.numXLevels(); x++) {
            if (!file.isValidLevel(x, y))
                continue;
            Box2i window = file.dataWindowForLevel(x, y);
            Planes planes = planes_of(form, window, x || y ? nullptr : pixels);
            file.setFrameBuffer(planes.frame(window));
            file.writeTiles(0, file.numXTiles(x) - 1, 0, file.numYTiles(y) - 1, x, y);
        }
}

template <class File> void write_lines(File &file, const exr_form &form, const float *pixels) {
    Box2i window = box(form.data);
    Planes planes = planes_of(form, window, pixels);
    file.setFrameBuffer(planes.frame(window));
    file.writePixels(window.max.y - window.min.y + 1);
}

/* Parts with depth, then the image, then another image, in the first one's windows. */
void write_parts(const char *path, const exr_form &form, const float *pixels) {
    std::vector<exr_form> forms;
    std::vector<Imf::Header> headers;
    for (int part = 0; part < form.decoys + 2; part++) {
        exr_form one = form;
        if (part != form.decoys) {
            one.tile = one.levels = 0;
            one.line_order = one.extra = 0;
            one.layer = "";
        }
        if (part < form.decoys)
            one.channels = "Z";
        Imf::Header header = header_of(one);
        header.setName("part" + std::to_string(part));
        header.setType(one.tile ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE);
        forms.push_back(one);
        headers.push_back(header);
    }
    Imf::MultiPartOutputFile file(path, headers.data(), int(headers.size()));
    for (int part = 0; part < int(forms.size()); part++) {
        const float *own = part == form.decoys ? pixels : nullptr;
        if (forms[size_t(part)].tile) {
            Imf::TiledOutputPart out(file, part);
            write_tiles(out, forms[size_t(part)], own);
        } else {
            Imf::OutputPart out(file, part);
            write_lines(out, forms[size_t(part)], own);
        }
    }
}

template <class Body> int guarded(const char *path, Body body) {
    try {
        body();
        return 1;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s: %s\n", path, error.what());
        return 0;
    }
}

void write_deep(const char *path, bool tiles) {
    Box2i window(V2i(0, 0), V2i(7, 7));
    Imf::Header header(window, window);
    Imf::Array2D<unsigned> counts(8, 8);
    Imf::Array2D<float *> pixels(8, 8);
    std::vector<float> samples(64, 0.5f);
    Imf::DeepFrameBuffer frame;
    header.compression() = Imf::ZIPS_COMPRESSION;
    for (int i = 0; i < 64; i++) {
        counts[i / 8][i % 8] = 1;
        pixels[i / 8][i % 8] = &samples[size_t(i)];
    }
    frame.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char *>(&counts[0][0]),
                                            sizeof(unsigned), sizeof(unsigned) * 8));
    for (const char *name : {"R", "G", "B"}) {
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        frame.insert(name, Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char *>(&pixels[0][0]),
                                          sizeof(float *), sizeof(float *) * 8, sizeof(float)));
    }
    if (tiles) {
        header.setType(Imf::DEEPTILE);
        header.setTileDescription(Imf::TileDescription(4, 4));
        Imf::DeepTiledOutputFile file(path, header);
        file.setFrameBuffer(frame);
        file.writeTiles(0, 1, 0, 1);
    } else {
        header.setType(Imf::DEEPSCANLINE);
        Imf::DeepScanLineOutputFile file(path, header);
        file.setFrameBuffer(frame);
        file.writePixels(8);
    }
}

void write_chroma(const char *path) {
    std::vector<Imf::Rgba> pixels(64, Imf::Rgba(0.25f, 0.5f, 0.75f, 1));
    Imf::RgbaOutputFile file(path, 8, 8, Imf::WRITE_YC);
    file.setFrameBuffer(pixels.data(), 1, 8);
    file.writePixels(8);
}

/* 8 x 8 pixels of zeros, each channel every `sampling` pixels. */
void write_plain(const char *path, std::vector<const char *> names, Imf::PixelType type,
                 int sampling) {
    Imf::Header header(8, 8);
    std::vector<unsigned> zeros(64);
    Imf::FrameBuffer frame;
    for (const char *name : names) {
        header.channels().insert(name, Imf::Channel(type, sampling, sampling));
        frame.insert(name, Imf::Slice(type, reinterpret_cast<char *>(zeros.data()), 4, 32, sampling,
                                      sampling));
    }
    Imf::OutputFile file(path, header);
    file.setFrameBuffer(frame);
    file.writePixels(8);
}

} // namespace

const char *exr_compression_name(int compression) {
    static const char *const names[EXR_COMPRESSIONS] = {"none",  "rle", "zips", "zip",  "piz",
                                                        "pxr24", "b44", "b44a", "dwaa", "dwab"};
    return names[compression];
}

int exr_is_lossy(const exr_form *form) {
    return form->compression == Imf::PXR24_COMPRESSION
               ? form->floats
               : form->compression >= Imf::DWAA_COMPRESSION ||
                     (form->compression >= Imf::B44_COMPRESSION && !form->floats);
}

int exr_write(const char *path, const exr_form *form, const float *pixels) {
    return guarded(path, [&] {
        if (form->decoys) {
            write_parts(path, *form, pixels);
        } else if (form->tile) {
            Imf::TiledOutputFile file(path, header_of(*form));
            write_tiles(file, *form, pixels);
        } else {
            Imf::OutputFile file(path, header_of(*form));
            write_lines(file, *form, pixels);
        }
    });
}

int exr_read(const char *path, const exr_form *form, float *pixels) {
    return guarded(path, [&] {
        Imf::MultiPartInputFile file(path);
        Imf::InputPart part(file, form->decoys);
        Box2i window = box(form->data);
        size_t n = std::strlen(form->channels), width = size_t(window.max.x - window.min.x + 1);
        Imf::FrameBuffer frame;
        for (size_t c = 0; c < n; c++)
            frame.insert(form->layer + std::string(1, form->channels[c]),
                         Imf::Slice::Make(Imf::FLOAT, pixels + c, window, n * sizeof(float),
                                          n * width * sizeof(float)));
        part.setFrameBuffer(frame);
        part.readPixels(window.min.y, window.max.y);
    });
}

int exr_write_odd(const char *path, int kind) {
    return guarded(path, [&] {
        switch (kind) {
        case EXR_DEEP:
        case EXR_DEEP_TILES:
            return write_deep(path, kind == EXR_DEEP_TILES);
        case EXR_UINT:
            return write_plain(path, {"R", "G", "B"}, Imf::UINT, 1);
        case EXR_SUBSAMPLED:
            return write_plain(path, {"R", "G", "B"}, Imf::FLOAT, 2);
        case EXR_CHROMA:
            return write_chroma(path);
        case EXR_TWO_LAYERS:
            return write_plain(path, {"a.R", "a.G", "a.B", "b.Y"}, Imf::FLOAT, 1);
        default:
            return write_plain(path, {"U", "V"}, Imf::FLOAT, 1);
        }
    });
}
