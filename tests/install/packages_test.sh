#!/usr/bin/env bash
# Makes the Debian packages of a build, unpacks them, and looks at what came out.   packages_test.sh BUILD
set -euo pipefail
build=$(realpath "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "packages_test: $*" >&2; exit 1; }
if ! command -v dpkg-deb >/dev/null; then
  echo "packages_test: not run: there is no dpkg-deb"
  exit 0
fi

(cd "$build" && cpack -G DEB -B "$work/packages" >"$work/log" 2>&1) || fail "$(cat "$work/log")"
for package in vkopple libvkopple0 libvkopple-dev; do
  file=$(echo "$work"/packages/"$package"_*.deb)
  [[ -f $file ]] || fail "there is no package $package: $(ls "$work/packages")"
  dpkg-deb -x "$file" "$work/tree"
  dpkg-deb -c "$file" | awk '{ print $6 }' >"$work/$package.list"
  [[ $(dpkg-deb -f "$file" Package) == "$package" ]] || fail "$file is named otherwise"
done
dpkg-deb -f "$(echo "$work"/packages/libvkopple-dev_*)" Depends | grep -q '^libvkopple0 (= ' || fail "libvkopple-dev does not depend on its library"
if command -v dpkg-shlibdeps >/dev/null; then
  for package in vkopple libvkopple0; do
    dpkg-deb -f "$(echo "$work/packages/${package}"_*)" Depends | grep -q libvulkan1 || fail "$package does not depend on the Vulkan loader"
  done
fi
holds() { grep -qx "./usr/$2" "$work/$1.list" || fail "$1 lacks /usr/$2: $(cat "$work/$1.list")"; }
holds vkopple bin/vkopple
holds vkopple share/bash-completion/completions/vkopple
holds vkopple share/zsh/vendor-completions/_vkopple
holds vkopple share/fish/vendor_completions.d/vkopple.fish
read_page() { case $1 in *.gz) zcat "$1" ;; *) cat "$1" ;; esac; }
for command in "" $("$work/tree/usr/bin/vkopple" completion bash | sed -nE "s/^      ([a-z-]+)\) words=.*/-\1/p"); do
  page=$(echo "$work/tree/usr/share/man/man1/vkopple$command".1*)
  [[ -f $page ]] || fail "there is no manual of vkopple$command"
  read_page "$page" >"$work/page"
  grep -q '^\.TH' "$work/page" || fail "the manual of vkopple$command is no manual page: $(cat "$work/page")"
done
holds vkopple share/vkopple/trained/rooms-small.safetensors
holds libvkopple0 lib/libvkopple.so.0
holds libvkopple-dev include/vkopple.h
holds libvkopple-dev lib/libvkopple.so
holds libvkopple-dev lib/pkgconfig/vkopple.pc
holds libvkopple-dev lib/cmake/vkopple/vkoppleConfig.cmake
holds libvkopple-dev share/doc/libvkopple-dev/examples/c/see.c
said=$("$work/tree/usr/bin/vkopple" --version)
[[ $said == "vkopple $(dpkg-deb -f "$(echo "$work"/packages/vkopple_*)" Version | sed 's/-.*//')" ]] || fail "the unpacked program says: $said"
echo "packages_test: passed"
