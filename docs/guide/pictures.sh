#!/bin/sh
# pictures.sh PROGRAM FOLDER: makes the pictures of the guide anew, by the commands of its pages. Scans and meshes go to
# FOLDER; copy FOLDER/*.jpg and FOLDER/pages/*.png into docs/guide/ after looking at them. Takes half a minute; needs python3-pil.
set -eu
program=$(realpath "$1")
here=$(realpath "$(dirname "$0")")
mkdir -p "$2"
cd "$2"
soapfilm() { "$program" --quiet "$@"; }

# turntable.md
soapfilm scan part -o turn --size 80 --orbit ring --elevations 10,45 --views 12 --image 120x120 --noise 0.05
soapfilm scan part -o both --size 80 --orbit ring --elevations 10,45,-45 --views 12 --image 120x120 --noise 0.05
soapfilm reconstruct turn/scans.conf -o turn.ply --voxel 0.6
soapfilm reconstruct both/scans.conf -o both.ply --voxel 0.6
soapfilm render turn/scans.conf turn.ply both.ply -o turntable.png --up z --view 1,-1,-0.8 --size 210x180 \
  --caption "scans, from below" --caption "never seen from below" --caption "also scanned upside down"

# room.md: the picture has no ceiling
python3 "$here/room.py" room.ply
soapfilm reconstruct room.ply -o inside.obj --voxel 0.06
soapfilm reconstruct room.ply -o closed.obj --voxel 0.06 --outside air 2>closed.txt
for mesh in inside closed; do
  awk '/^v /{z[++n]=$4} /^f /{if(z[$2+0]>2.3||z[$3+0]>2.3||z[$4+0]>2.3)next} {print}' $mesh.obj >open-$mesh.obj
done
soapfilm render open-inside.obj open-closed.obj -o room.png --up z --view 0.7,-1,1.3 --size 310x240 \
  --caption "--outside solid (chosen)" --caption "--outside air: an outer shell is made up"

# open-surface.md
python3 "$here/terrain.py" terrain.xyz
soapfilm reconstruct terrain.xyz -o terrain.ply --voxel 2 2>terrain.txt
soapfilm reconstruct terrain.xyz -o block.ply --voxel 2 --outside air 2>block.txt
soapfilm scan facade -o facade --image 300x100 --noise 0.003
soapfilm reconstruct facade/scans.conf -o facade.ply
soapfilm render terrain.ply block.ply -o terrain.png --up z --view 1,-1,0.5 --size 310x160 \
  --caption "--outside open (chosen)" --caption "--outside air: sides and bottom are made up"
soapfilm render facade/scans.conf facade.ply -o facade.png --up z --view -0.4,-1,0.3 --framing shared --size 310x200 \
  --caption "three scans" --caption "mesh"

# sparse.md
python3 "$here/sparse.py" uneven.xyz
soapfilm reconstruct uneven.xyz -o one.ply
soapfilm reconstruct uneven.xyz -o several.ply --adapt on
soapfilm render one.ply several.ply -o sparse.png --view 1,0,0 --framing shared --size 310x310 \
  --caption "one voxel size" --caption "--adapt on"
python3 "$here/carved.py" stone.obj
soapfilm scan stone.obj -o stone --rays spinning --position 0,0,1 --image 1200x250 --span=-50,30 --noise 0.0005 \
  --max-range 25 --max-incidence 89
soapfilm reconstruct stone/scans.conf -o whole.ply
soapfilm reconstruct stone/scans.conf -o carved.ply --adapt on --voxel 0.01
soapfilm render whole.ply carved.ply -o carved.png --up z --view -0.5,-1,0.4 --framing shared --size 310x310 \
  --zoom 0.457,0.445,0.507,0.495 --caption "one voxel size" --caption "--adapt on --voxel 0.01"

# holes.md
python3 "$here/holes.py" ball.xyz
soapfilm reconstruct ball.xyz -o all.ply
soapfilm reconstruct ball.xyz -o some.ply --fill-holes 0.7 2>some.txt
soapfilm reconstruct ball.xyz -o none.ply --trim auto --trim-holes
soapfilm render all.ply some.ply none.ply -o holes.png --up z --view 0.5,-1,0.3 --size 210x200 \
  --caption "all filled" --caption "--fill-holes 0.7" --caption "--trim auto --trim-holes"

# noisy-cloud.md
soapfilm scan knot -o noisy --samples 30000 --noise 0.7% --outliers 0.1
soapfilm reconstruct noisy/samples.ply --directions estimate -o noisy.ply 2>noisy.txt
soapfilm reconstruct noisy/samples.ply --directions estimate -o debris.ply --lambda 0.002 --drop-components off \
  2>debris.txt
soapfilm render noisy/samples.ply noisy.ply debris.ply -o noisy-cloud.png --size 210x190 --view 0.3,-0.4,1 \
  --caption "cloud" --caption "mesh" --caption "--lambda 0.002, nothing dropped"

# photogrammetry.md
python3 "$here/photogrammetry.py" fused.ply
soapfilm reconstruct fused.ply -o vase.ply 2>vase.txt
soapfilm render fused.ply vase.ply -o photogrammetry.png --up z --view -1,-1,0.5 --size 310x260 \
  --caption "cloud" --caption "mesh"

# stockpile.md
python3 "$here/stockpile.py" may.xyz june.xyz
for month in may june; do soapfilm reconstruct $month.xyz -o $month.ply --voxel 0.4; done
soapfilm measure june.ply --section z=100.5:105.5:1 --contours june.svg
soapfilm render may.ply june.ply -o stockpile.png --up z --view 0.6,-1,0.9 --size 310x200 --caption May --caption June
chromium --headless --no-sandbox --window-size=1000,1000 --screenshot=contours.png "file://$PWD/june.svg"
/usr/bin/python3 - <<'END'
from PIL import Image
yard, contours = Image.open("stockpile.png").convert("RGB"), Image.open("contours.png").convert("RGB")
both = Image.new("RGB", (yard.width + 210, yard.height), "white")
both.paste(yard, (0, 0))
both.paste(contours.resize((200, 200), Image.LANCZOS), (yard.width + 5, 0))
both.save("stockpile.png")
END
rm contours.png

# cad.md
soapfilm scan part -o cad --size 80 --samples 1000
soapfilm scan part -o made --size 80.2 --center 0.5,-0.3,0.2 --orbit fibonacci --views 24 --image 160x160 --noise 0.02
soapfilm reconstruct made/scans.conf -o made.ply --voxel 0.5
soapfilm compare made.ply cad/truth.ply --align --tolerance 0.15 --unit mm --picture cad.png
/usr/bin/python3 - <<'END'
from PIL import Image
picture = Image.open("cad.png").convert("RGB")
picture.resize((720, round(picture.height * 720 / picture.width)), Image.LANCZOS).save("cad.png")
END

# methods.md
soapfilm scan part -o views --image 120x120 --noise 0.3%
for method in tv tv-sor poisson graph-cut-6 graph-cut-26 vrip; do
  soapfilm reconstruct views/scans.conf -o $method.ply --resolution 128 --method $method
  soapfilm evaluate $method.ply --truth part --points 20000 --error-ply error-$method.ply >$method.txt
done
soapfilm render error-tv.ply error-tv-sor.ply error-poisson.ply error-graph-cut-6.ply error-graph-cut-26.ply \
  error-vrip.ply -o methods.png --columns 3 --size 210x165 --up z --view iso --color-by distance --range 0,0.006 \
  --caption tv --caption tv-sor --caption poisson --caption graph-cut-6 --caption graph-cut-26 --caption vrip

# trust.md
soapfilm scan torus -o hole --samples 20000 --noise 0.2% --hole 0.15
soapfilm reconstruct hole/samples.ply -o hole.ply --distance
soapfilm reconstruct hole/samples.ply -o cut.ply --distance --trim auto
soapfilm render hole/samples.ply hole.ply cut.ply -o trust.png --size 210x170 --up z --view 0.2,0.3,1 \
  --color-by distance --caption "samples" --caption "distance to the samples" --caption "--trim auto"

# smaller.md
soapfilm scan knot -o smaller --samples 80000
soapfilm reconstruct smaller/samples.ply -o full.ply --resolution 160
soapfilm simplify full.ply -o small.ply --tolerance 0.00034
soapfilm render full.ply small.ply -o smaller.png --size 380x300 --view 0.3,-0.4,1 --zoom 0.2,0.15,0.75,0.7 \
  --caption "full" --caption "a tenth of the triangles, within 0.05 voxel"

# tiles.md: needs chromium and a build with the viewer beside the program
sh "$here/../../viewer/test/run.sh" "$program" "$(dirname "$program")/../viewer" . tiles.test.mjs >tiles.txt

# viewer.md and browser.md: need chromium, a build with the viewer beside the program, and `make web`
soapfilm reconstruct hole/samples.ply -o hole.ply --report hole.report.json --distance --support --gap
sh "$here/../../viewer/test/run.sh" "$program" "$(dirname "$program")/../viewer" . pictures.mjs
SOAPFILM_PAGE="$here/../../out/web/index.html" sh "$here/../../viewer/test/run.sh" "$program" \
  "$(dirname "$program")/../viewer" . ../../web/test/pictures.mjs
/usr/bin/python3 - viewer.png viewer-narrow.png browser.png <<'END'
import sys
from PIL import Image
for name in sys.argv[1:]:
    picture = Image.open(name).convert("RGB")
    width = 1200 if picture.width > picture.height else 390
    picture = picture.resize((width, round(picture.height * width / picture.width)), Image.LANCZOS)
    picture.quantize(256, kmeans=2).save("small-" + name, optimize=True)
END
mkdir -p pages
rm viewer*.png browser.png
for name in viewer viewer-narrow browser; do mv "small-$name.png" "pages/$name.png"; done

/usr/bin/python3 - *.png <<'END'
import sys
from PIL import Image
for name in sys.argv[1:]:
    Image.open(name).convert("RGB").save(name[:-3] + "jpg", quality=85)
END
