# Sourced by ./run and ./check, which work from the source tree's root. shellcheck shell=bash

# ragtop_packages <section>...: the packages that packages.txt lists in those sections.
ragtop_packages() {
    local section
    for section in "$@"; do
        sed -n "s/^$section:[[:space:]]*//p" packages.txt
    done
}

# ragtop_missing <package>...: those of the packages that are not installed.
ragtop_missing() {
    local installed package
    # dpkg-query complains about, and fails for, packages it has never heard of: those are simply missing.
    installed=$(dpkg-query -W -f='${Package} ${db:Status-Status}\n' "$@" 2>/dev/null || true)
    for package in "$@"; do
        case $'\n'$installed$'\n' in
        *$'\n'"$package installed"$'\n'*) ;;
        *) echo "$package" ;;
        esac
    done
}

# ragtop_setup <section>...: installs what is missing of those sections, and touches nothing when all is there.
ragtop_setup() {
    local listed missing
    local -a as_root=(env)
    if ! command -v dpkg-query >/dev/null; then
        echo "No dpkg here: install the equivalents of packages.txt by hand; going on with what there is." >&2
        return 0
    fi
    listed=$(ragtop_packages "$@")
    # Unquoted below: lists of package names.
    missing=$(ragtop_missing $listed)
    [ -n "$missing" ] || return 0
    echo "Installing:" $missing
    if [ "$(id -u)" -ne 0 ]; then
        if ! command -v sudo >/dev/null; then
            echo "Not root and no sudo; as root: apt-get install --no-install-recommends" $missing >&2
            return 1
        fi
        as_root=(sudo env)
    fi
    as_root+=(DEBIAN_FRONTEND=noninteractive apt-get -q -o APT::Install-Recommends=false)
    "${as_root[@]}" update </dev/null
    "${as_root[@]}" install -y --no-install-recommends $missing </dev/null
}
