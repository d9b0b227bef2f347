# shellcheck shell=bash disable=SC2154
# Sourced by tools/test-drivers: Vulkan drivers from Debian's packages, unpacked into build/drivers/NAME and installed nowhere.
# Packages are found with lists of their own, of this Debian and its backports, from the mirror that the machine's apt uses.

drivers=$root/build/drivers
apt_folder=$drivers/apt
debian_keys=/usr/share/keyrings/debian-archive-keyring.gpg

declare -A driver_package=([lavapipe]=mesa-vulkan-drivers [lavapipe-backports]=mesa-vulkan-drivers [swiftshader]=chromium-common)
declare -A driver_icd=([lavapipe]='lvp_icd*.json' [lavapipe-backports]='lvp_icd*.json' [swiftshader]='vk_swiftshader_icd.json')

own_apt() { # apt-get's or apt-cache's name, arguments
  "$1" -o Dir::Etc::SourceList="$apt_folder/sources.list" -o Dir::Etc::SourceParts="$apt_folder/none" \
    -o Dir::State::Lists="$apt_folder/lists" -o Dir::Cache="$apt_folder/cache" -o Debug::NoLocking=1 "${@:2}"
}

# Lists of packages, once a run of this script.
update_lists() {
  [[ -z ${lists_are_new:-} ]] || return 0
  command -v apt-get >/dev/null || { echo "apt-get is missing: drivers come from Debian's packages" >&2; return 1; }
  local codename signed="" mirrors
  codename=$(sed -nE 's/^VERSION_CODENAME=//p' /etc/os-release)
  [[ -f $debian_keys ]] && signed="[signed-by=$debian_keys] "
  # Lines "MIRROR RELEASE"; what others than Debian offer for it goes by other names of releases.
  mirrors=$(apt-get update --print-uris | sed -nE "s|^'([^']+)/dists/($codename(-security\|-updates)?)/InRelease' .*|\1 \2|p")
  [[ $mirrors == *" $codename"$'\n'* || $mirrors == *" $codename" ]] || { echo "apt knows no mirror of Debian's release '$codename'" >&2; return 1; }
  mkdir -p "$apt_folder"/{none,lists/partial,cache/archives/partial}
  {
    sed -E "s|^(.*) (.*)|deb $signed\1 \2 main|" <<<"$mirrors"
    sed -nE "s|^(.*) $codename\$|deb $signed\1 $codename-backports main|p" <<<"$mirrors"
  } >"$apt_folder/sources.list"
  own_apt apt-get -qq update || { echo "the lists of packages can't be had" >&2; return 1; }
  backports=$codename-backports
  lists_are_new=yes
}

# What to unpack for a driver, as apt-get download takes it: its package, and what that needs newer than it is installed.
wanted_packages() { # driver
  local package=${driver_package[$1]}
  case $1 in
    swiftshader) echo "$package" ;; # the browser's own needs are none of the driver's
    lavapipe) echo "$package" ;;
    lavapipe-backports)
      own_apt apt-get install --print-uris -qq --reinstall --no-install-recommends "$package/$backports" |
        sed -nE "s/^'[^']*' ([^_]+)_([^_]+)_.*/\1=\2/p" | sed 's/%3a/:/g'
      ;;
  esac
}

# Where the unpacked libraries lie, for LD_LIBRARY_PATH; nothing where there are none but the driver's own.
library_path() { # driver
  [[ $1 == lavapipe-backports ]] || return 0
  find "$drivers/$1/root/usr/lib" -maxdepth 2 -name '*.so*' -printf '%h\n' | sort -u | paste -sd:
}

# Fetches and unpacks a driver unless it is there; says on standard error why it can't be had.
fetch_driver() { # name
  local folder=$drivers/$1 packages icd library missing
  [[ -f $folder/icd.json ]] && return 0
  rm -rf "$folder"
  mkdir -p "$folder/debs"
  update_lists || return 1
  mapfile -t packages < <(wanted_packages "$1")
  ((${#packages[@]})) || { echo "no package of $1 is offered" >&2; return 1; }
  (cd "$folder/debs" && own_apt apt-get -qq -o APT::Sandbox::User=root download "${packages[@]}") || return 1
  for deb in "$folder"/debs/*.deb; do
    if [[ $1 == swiftshader ]]; then # of a browser, the two files alone
      mkdir -p "$folder/root"
      dpkg-deb --fsys-tarfile "$deb" | tar -x -C "$folder/root" --wildcards '*swiftshader*'
    else
      dpkg -x "$deb" "$folder/root"
    fi
  done
  dpkg-deb -f "$folder"/debs/"${driver_package[$1]}"_*.deb Version >"$folder/version"
  rm -r "$folder/debs"
  icd=$(find "$folder/root" -name "${driver_icd[$1]}" -print -quit)
  [[ -n $icd ]] || { echo "the package has no ${driver_icd[$1]}" >&2; return 1; }
  library=$(sed -nE 's/.*"library_path": *"([^"]*\/)?([^"\/]+)".*/\2/p' "$icd")
  library=$(find "$folder/root" -name "$library" -print -quit)
  [[ -n $library ]] || { echo "the library that $icd names is not in the package" >&2; return 1; }
  missing=$(LD_LIBRARY_PATH=$(library_path "$1") ldd "$library" | sed -nE 's/^\s*(\S+) => not found.*/\1/p' | paste -sd' ')
  [[ -z $missing ]] || { echo "libraries are missing: $missing" >&2; return 1; }
  sed -E "s|(\"library_path\": *)\"[^\"]*\"|\1\"$library\"|" "$icd" >"$folder/icd.json"
}
