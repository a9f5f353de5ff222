#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds an OpenImageIO of few libraries into a folder, for the wheel: Debian's brings 269 along, video codecs and PDF
# readers among them.
#
#   cmake/openimageio.sh build/wheel/openimageio
#
# The sources come from the package index that pip asks, which are everywhere where pip is. A static library of the kinds of
# pictures that the program reads and writes, for libgazetrace_pictures.so to take in.
set -eu
[ $# = 1 ] || { echo "usage: $0 FOLDER" >&2; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
folder=$(cd "$1" && pwd)
version=3.0.21.0
[ ! -e "$folder/built-$version" ] || exit 0

if [ ! -e "$folder/openimageio-$version.tar.gz" ]; then
  echo "openimageio==$version --hash=sha256:404540688f14a770de37fc545aa7d17bec222e4bd44aefe39b0f6393eafcf086" > "$folder/source.txt"
  python3 -m venv "$folder/venv"
  "$folder/venv/bin/pip" download --quiet --disable-pip-version-check --no-deps --no-binary openimageio --require-hashes \
    -r "$folder/source.txt" -d "$folder"
fi
rm -rf "$folder/venv" "$folder/openimageio-$version" "$folder/build"
tar -xf "$folder/openimageio-$version.tar.gz" -C "$folder"
source=$folder/openimageio-$version
mkdir -p "$source/testsuite/common" && touch "$source/testsuite/runtest.py"  # the tests are looked for, and are not in the sources
# It asks for OpenColorIO 2.2, and Debian 12 has 2.1. What is new in 2.2 tells how colour spaces are named; nothing here asks.
sed -i '/(OpenColorIO REQUIRED/{n;s/VERSION_MIN 2.2/VERSION_MIN 2.1/}' "$source/src/cmake/externalpackages.cmake"
sed -i -e 's/OCIO::Config::GetProcessorToBuiltinColorSpace(config_,/config_->getProcessor(/' \
  -e 's/proc->apply(OCIO::PackedImageDesc(\(.*\)));/OCIO::PackedImageDesc pixels(\1); proc->apply(pixels);/' \
  -e '/^ColorConfig::Impl::isColorSpaceLinear/,/^}/{/if (config_ &&/,/^    }/d}' \
  -e '/^ColorConfig::createNamedTransform/,/^}/s/(context, transform, dir)/(context, transform->getTransform(dir), OCIO::TRANSFORM_DIR_FORWARD)/' \
  "$source/src/libOpenImageIO/color_ocio.cpp"

off=""
for name in bmp:keep cineon dds dicom dpx:keep ffmpeg fits gif hdr:keep heif ico iff jpeg:keep jpeg2000 jpegxl null openexr:keep \
            openvdb png:keep pnm psd ptex r3d raw rla sgi softimage targa term tiff webp:keep zfile \
            TBB Freetype OpenCV DCMTK FFmpeg GIF Libheif LibRaw OpenJPEG openjph OpenVDB Ptex R3DSDK Nuke BZip2 JXL libuhdr \
            Qt5 Qt6 OpenGL; do
  case $name in *:keep) ;; *) off="$off -DENABLE_$name=OFF" ;; esac
done
launcher=""
if command -v ccache > /dev/null; then
  launcher="-DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_C_COMPILER_LAUNCHER=ccache"
fi
# shellcheck disable=SC2086
cmake -G Ninja -S "$source" -B "$folder/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$folder/installed" \
  -DCMAKE_CXX_FLAGS_RELEASE="-O2 -DNDEBUG -ffunction-sections -fdata-sections" -DCMAKE_MODULE_PATH="$here" \
  -DBUILD_SHARED_LIBS=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DOIIO_BUILD_TOOLS=OFF -DOIIO_BUILD_TESTS=OFF -DBUILD_TESTING=OFF \
  -DUSE_PYTHON=OFF -DUSE_QT=OFF -DUSE_JXL=OFF -DBUILD_DOCS=OFF -DINSTALL_DOCS=OFF -DINSTALL_FONTS=OFF -DSTOP_ON_WARNING=OFF \
  -DCMAKE_UNITY_BUILD=ON -DOpenImageIO_BUILD_MISSING_DEPS=none $off $launcher
cmake --build "$folder/build"
cmake --install "$folder/build" --strip
touch "$folder/built-$version"
