#include "compare/image_io.h"

#include <fmt/format.h>

#include "compare/atomic_file.h"
#include "core/error.h"

#ifdef ONEPASS_WITH_OPENIMAGEIO
#include <OpenImageIO/imageio.h>
#endif

namespace onepass {
namespace fs = std::filesystem;

#ifdef ONEPASS_WITH_OPENIMAGEIO

namespace {

[[noreturn]] void refuse(const fs::path& path, const std::string& reason) {
    throw Error({path.string(), reason, "an image file that can be written",
                 "Check the path, its extension and the disk."});
}

void write_image(const fs::path& path, const OIIO::ImageSpec& spec, const void* pixels) {
    write_atomically(path, [&](const fs::path& temporary) {
        const auto file = OIIO::ImageOutput::create(temporary.string());
        if (!file) refuse(path, OIIO::geterror());
        const bool written = file->open(temporary.string(), spec) &&
                             file->write_image(OIIO::TypeDesc::UNKNOWN, pixels) && file->close();
        if (!written) refuse(path, file->geterror());
    });
}

}  // namespace

bool image_files_supported() { return true; }

std::string image_io_description() {
    const int version = OIIO::openimageio_version();
    return fmt::format("OpenImageIO {}.{}.{}", version / 10000, version / 100 % 100, version % 100);
}

void write_png(const fs::path& path, const Picture& picture) {
    OIIO::ImageSpec spec(static_cast<int>(picture.width), static_cast<int>(picture.height), 3,
                         OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    write_image(path, spec, picture.pixels.data());
}

void write_exr(const fs::path& path, uint32_t width, uint32_t height,
               const std::vector<Channel>& channels) {
    OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height),
                         static_cast<int>(channels.size()), OIIO::TypeDesc::FLOAT);
    spec.channelnames.clear();
    for (const Channel& channel : channels) {
        spec.channelnames.push_back(channel.name);
        spec.channelformats.push_back(channel.values.index() == 0 ? OIIO::TypeDesc::FLOAT
                                                                  : OIIO::TypeDesc::UINT32);
    }
    spec.attribute("compression", "zip");
    write_image(path, spec, interleaved(channels).data());
}

#else

namespace {

[[noreturn]] void refuse(const fs::path& path) {
    throw Error({path.string(), "a build without OpenImageIO", "a name that ends in .npy",
                 "Write .npy, or build with ONEPASS_WITH_OPENIMAGEIO=ON."});
}

}  // namespace

bool image_files_supported() { return false; }
std::string image_io_description() { return "not built in"; }
void write_png(const fs::path& path, const Picture&) { refuse(path); }
void write_exr(const fs::path& path, uint32_t, uint32_t, const std::vector<Channel>&) {
    refuse(path);
}

#endif

}  // namespace onepass
