#!/usr/bin/env bash
# Reads figures for print with programs that are not ours: poppler finds a page of the width, every font embedded and the text of each
# drawing in the PDF, and draws it.
#
#   .ci/check_figures.sh FOLDER WIDTH_MM
#
# Needs pdfinfo, pdffonts, pdftotext and pdftoppm (Debian: poppler-utils). Exit code 0 where everything is so, 1 where something is not.
set -euo pipefail
folder=$1 width=$2
failed=0
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fault() { echo "FAIL  $1"; failed=1; }
count=0
for pdf in "$folder"/*.pdf; do
  count=$((count + 1))
  stem=${pdf%.pdf}
  points=$(pdfinfo "$pdf" | sed -n 's/^Page size: *\([0-9.]*\) x.*/\1/p')
  awk -v found="$points" -v mm="$width" 'BEGIN { d = found - mm * 72 / 25.4; exit !(d < 0.05 && d > -0.05) }' ||
    fault "$pdf is $points pt wide, expected $width mm"
  pdffonts "$pdf" | tail -n +3 | awk '{ if ($(NF - 4) != "yes") exit 1; n++ } END { exit n == 0 }' ||
    fault "$pdf has a font that is not embedded, or none"
  # Every text of the drawing, but for the order and the spaces.
  pdftotext "$pdf" - | tr -d ' \n\f' >"$work/text"
  sed 's/<title>[^<]*<\/title>//g' "$stem.svg" | grep -o '<text[^>]*>[^<]*' | sed 's/^<text[^>]*>//' |
    sed 's/&lt;/</g; s/&gt;/>/g; s/&quot;/"/g; s/&apos;/'"'"'/g; s/&amp;/\&/g' >"$work/wanted"
  while IFS= read -r line; do
    [ -z "$line" ] || grep -qF -- "$(tr -d ' ' <<<"$line")" "$work/text" || fault "$pdf does not say: $line"
  done <"$work/wanted"
  pdftoppm -r 60 -png "$pdf" "$work/page" && [ -s "$(ls "$work"/page*.png | head -n 1)" ] || fault "$pdf cannot be drawn"
  [ "$(wc -l <"$stem.csv")" -ge 2 ] || fault "$stem.csv has no line"
done
[ "$count" -gt 0 ] || fault "$folder holds no PDF"
echo "$count figures of $width mm"
exit $failed
