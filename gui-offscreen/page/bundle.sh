#!/usr/bin/env bash
# Makes bundle/page.js and page.css of the modules here and their libraries. Only who changes the page needs it, and npm.
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cp "$here"/*.js "$here"/*.css "$scratch"
cd "$scratch"
npm init -y >/dev/null
npm install --silent three@0.187.0 uplot@1.6.32 fflate@0.8.3 esbuild@0.28.2
npx esbuild main.js --bundle --minify --format=iife --target=es2020 --charset=utf8 --legal-comments=none --outfile=page.js
{ cat node_modules/uplot/dist/uPlot.min.css; echo; cat page.css; } >whole.css
npx esbuild whole.css --minify --charset=utf8 --outfile=page.min.css
# A script of a page ends at the first "</script".
sed -i 's#</script#<\\/script#g' page.js
mkdir -p "$here/bundle"
{ echo "/* three.js, uPlot, fflate (MIT license, docs/LICENSE.md) and gui-offscreen/page */"; cat page.js; } >"$here/bundle/page.js"
cp page.min.css "$here/bundle/page.css"
