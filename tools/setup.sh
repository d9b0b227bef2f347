# shellcheck shell=bash disable=SC2034
# Sourced by tools/demo and tools/test: installs what is missing, builds, and defines `vkopple`, the program built.
# docs/dependencies.md says what each package is for.

packages=(
  g++ cmake ninja-build pkg-config
  libvulkan-dev mesa-vulkan-drivers vulkan-validationlayers glslang-tools spirv-tools
  libglm-dev libopenimageio-dev libarchive-dev libprotobuf-dev protobuf-compiler nlohmann-json3-dev libcli11-dev libspdlog-dev libfmt-dev libgtest-dev libgmock-dev
  libopenmpi-dev openmpi-bin
)
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
preset=release
vkopple=$root/build/$preset/vkopple

say() { printf '\n== %s\n' "$*"; }

missing_packages() {
  local installed package
  installed=" $(dpkg-query -W -f='${db:Status-Status}:${Package} ' "${packages[@]}" 2>/dev/null || true)"
  for package in "${packages[@]}"; do
    [[ $installed == *" installed:$package "* ]] || echo "$package"
  done
}

install_packages() {
  if ! command -v dpkg-query >/dev/null; then
    echo "Not a Debian system: trusting that these are there under other names: ${packages[*]}"
    return
  fi
  local missing as_root=()
  mapfile -t missing < <(missing_packages)
  ((${#missing[@]})) || return 0
  say "Installing ${missing[*]}"
  if ((EUID != 0)); then
    command -v sudo >/dev/null || { echo "Run as root: apt-get install ${missing[*]}" >&2; return 1; }
    as_root=(sudo)
  fi
  "${as_root[@]}" apt-get -qq update
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=120 -o Dpkg::Use-Pty=0 \
    install --no-install-recommends "${missing[@]}" >/dev/null
}

build() { # targets, all without any
  say "Building into build/$preset"
  (cd "$root" && cmake --preset "$preset" >/dev/null && cmake --build --preset "$preset" ${1:+--target "$@"})
}
