#!/usr/bin/env bash
# Installs the Python module to a prefix, and uses it and its program from there.
#   install.sh BUILD FOLDER      FOLDER: that of the packages, below the prefix
set -euo pipefail
prefix=$(mktemp -d)
trap 'rm -rf "$prefix"' EXIT
cmake --install "$1" --prefix "$prefix" --component python >/dev/null
mkdir -p "$prefix/bin"
cp "$1/bin/splinecast" "$prefix/bin"
cd /
export PYTHONPATH="$prefix/$2" PATH=/usr/bin:/bin
test "$(/usr/bin/python3 -c 'import splinecast; print(splinecast.__file__)')" = "$PYTHONPATH/splinecast/__init__.py"
/usr/bin/python3 -m splinecast methods | grep -q c2
# The interpreter finds the folder without PYTHONPATH below /usr/local and /usr.
for system in /usr/local /usr; do
  /usr/bin/python3 -c "import site, sys; sys.exit('$system/$2' not in site.getsitepackages())"
done
# The extension exports its one function, and no symbol of the library inside.
test "$(nm -D --defined-only "$PYTHONPATH"/splinecast/_splinecast*.so | grep -c ' [TtVvWwDdBb] ')" = 1
