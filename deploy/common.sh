# Shared by deploy/run and deploy/test; sourced with the checkout's root as the working directory.

say() {
	printf '== %s\n' "$*"
}

die() {
	printf '%s: %s\n' "$program" "$*" >&2
	exit 1
}

# The packages of the named groups, of deploy/packages.
packages() {
	for group in "$@"; do
		sed -n "s/^$group //p" deploy/packages
	done
}

# Those of the arguments that are not installed.
missing_of() {
	installed=$(dpkg-query -W -f '${db:Status-Abbrev} ${Package}\n' "$@" 2>/dev/null | sed -n 's/^ii *//p')
	for package in "$@"; do
		printf '%s\n' "$installed" | grep -qxF "$package" || printf '%s\n' "$package"
	done
}

as_root() {
	if [ "$(id -u)" = 0 ]; then
		"$@"
	elif command -v sudo >/dev/null; then
		sudo "$@"
	else
		die "packages are missing; run as root once, or: apt-get install$(printf ' %s' $missing)"
	fi
}

# Install what the named groups lack. With nothing missing this needs neither root nor a network.
install_packages() {
	command -v dpkg-query >/dev/null && command -v apt-get >/dev/null ||
		die "this is no Debian; install the equivalents of the packages in deploy/packages, then build with cmake --preset release"
	# shellcheck disable=SC2046
	missing=$(missing_of $(packages "$@"))
	[ -z "$missing" ] && return
	say "installing$(printf ' %s' $missing)"
	as_root apt-get update -qq
	# shellcheck disable=SC2086
	as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >build/apt.log 2>&1 || {
		tail -20 build/apt.log >&2
		die "apt-get could not install the packages; build/apt.log says why"
	}
}

# Configure and build a preset; further arguments go to the configuration. Quiet unless it fails.
build_preset() {
	preset=$1
	shift
	say "building the $preset preset"
	if ! { cmake --preset "$preset" "$@" && cmake --build --preset "$preset"; } >"build/$preset.log" 2>&1; then
		tail -40 "build/$preset.log" >&2
		return 1
	fi
}

milliseconds() {
	date +%s%3N
}

# Shaders that a driver has compiled once stay compiled from run to run.
MESA_SHADER_CACHE_DIR=$PWD/build/shader-cache
export MESA_SHADER_CACHE_DIR
mkdir -p build
