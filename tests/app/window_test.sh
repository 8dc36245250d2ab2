#!/usr/bin/env bash
# The real window on a virtual screen, driven by xdotool: window_test.sh GLINT
# Pictures are compared byte for byte; all waits are for what the title says, and bounded.
set -euo pipefail
glint=$1

folder=$(mktemp -d)
viewer=
screen=
cleanup() {
  [ -z "$viewer" ] || kill "$viewer" 2>/dev/null || true
  [ -z "$screen" ] || kill "$screen" 2>/dev/null || true
  rm -rf "$folder"
}
trap cleanup EXIT

# start_screen OPTION...: a virtual screen of its own, which names its number itself once it answers: nobody guesses a free one.
# -noreset: or it would begin anew when its last client left, and refuse whoever comes meanwhile.
start_screen() {
  local number
  exec 3< <(exec Xvfb -displayfd 1 -noreset -nolisten tcp "$@" 2>"$folder/screen")
  screen=$!
  read -r -t 60 -u 3 number || { echo "FAILED: no virtual screen: $(cat "$folder/screen")" >&2; exit 1; }
  export DISPLAY=:$number
}

# Without any display: one line that names the way out, exit code 6.
code=0
line=$(env -u DISPLAY -u WAYLAND_DISPLAY "$glint" view builtin:dof 2>&1) || code=$?
[ "$code" = 6 ] || { echo "FAILED: exit code $code without a display" >&2; exit 1; }
[[ $line == *"glint render"* && $line != *$'\n'* ]] || { echo "FAILED: without a display: $line" >&2; exit 1; }
# A display without OpenGL: the same.
start_screen -screen 0 640x480x24 -extension GLX
code=0
line=$(env -u WAYLAND_DISPLAY "$glint" view builtin:dof 2>&1) || code=$?
[ "$code" = 6 ] || { echo "FAILED: exit code $code without OpenGL" >&2; exit 1; }
[[ $line == *"glint render"* && $line == *OpenGL* && $line != *$'\n'* ]] || { echo "FAILED: without OpenGL: $line" >&2; exit 1; }
kill "$screen"
start_screen -screen 0 1280x800x24
export XDG_PICTURES_DIR=$folder/pictures HOME=$folder
mkdir "$XDG_PICTURES_DIR"

fail() {
  echo "FAILED: $*; title: $(xdotool getwindowname "$window" 2>/dev/null || true)" >&2
  cat "$folder/errors" >&2
  exit 1
}

# A mirror ball and a glass ball on a matte floor under a point light; the second scene has nothing but the floor.
cat >"$folder/balls.p3f" <<'SCENE'
bclr 0.2 0.4 0.7
v
from 0 -5 2.5
at 0 0 0.5
up 0 0 1
angle 40
hither 0.01
resolution 200 150
aperture 0
focal 1
l -3 -3 5 1 1 1
f 0.8 0.7 0.5 1 0.2 0.2 0.2 0.2 10 0 1
pl 0 0 0 1 0 0 0 1 0
f 0.3 0.3 0.3 1 0.9 0.9 0.9 0.8 50 0 1
s -0.8 0 0.8 0.8
f 0.1 0.1 0.1 0.1 1 1 1 0.1 50 1 1.5
s 0.9 -0.2 0.7 0.7
SCENE
cat >"$folder/floor.p3f" <<'SCENE'
bclr 0.2 0.4 0.7
v
from 0 -5 2.5
at 0 0 0.5
up 0 0 1
angle 40
hither 0.01
resolution 160 120
aperture 0
focal 1
f 0.8 0.7 0.5 1 0 0 0 0 10 0 1
pl 0 0 0 1 0 0 0 1 0
SCENE

start() {
  "$glint" view "$@" --threads 2 >"$folder/output" 2>"$folder/errors" &
  viewer=$!
  window=
  for _ in $(seq 300); do
    # xdotool finds nothing until the window is mapped, and says so by its exit code.
    window=$(xdotool search --onlyvisible --pid "$viewer" --name '^glint' 2>/dev/null | head -n 1) || true
    [ -z "$window" ] || break
    kill -0 "$viewer" 2>/dev/null || fail "the viewer ended"
    sleep 0.1
  done
  [ -n "$window" ] || fail "no window"
  xdotool windowfocus --sync "$window"
}

# wait_title WORD...: until the title has every word, and none of those that begin with "!".
wait_title() {
  local title word met
  for _ in $(seq 600); do
    title=$(xdotool getwindowname "$window")
    met=1
    for word in "$@"; do
      if [ "${word#!}" != "$word" ]; then
        [[ " $title " != *" ${word#!}"[,\ ]* ]] || met=
      else
        [[ " $title " == *" $word"[,\ ]* ]] || met=
      fi
    done
    [ -z "$met" ] || return 0
    sleep 0.1
  done
  fail "the title never had: $*"
}

picture() { import -window "$window" -depth 8 rgb:- | sha256sum; }
press() { xdotool key "$1"; }
same() { [ "$(picture)" = "$1" ] || fail "$2: the picture changed"; }
other() { [ "$(picture)" != "$1" ] || fail "$2: the picture did not change"; }

# Takes a screenshot with key $1; it must be what the window shows, and have the size $2.
screenshot() {
  local before file
  before=$(wc -l <"$folder/output")
  press "$1"
  for _ in $(seq 100); do
    [ "$(wc -l <"$folder/output")" = "$before" ] || break
    sleep 0.1
  done
  file=$(tail -n 1 "$folder/output")
  [ -f "$file" ] && [ "$(dirname "$file")" = "$XDG_PICTURES_DIR" ] || fail "no screenshot: '$file'"
  [ "$(identify -format '%wx%h' "$file")" = "$2" ] || fail "$file has another size than $2"
  import -window "$window" "$folder/grab.png"
  "$glint" compare "$folder/grab.png" "$file" >/dev/null || fail "$file is not what the window shows"
}

# What each key does ------------------------------------------------------------------------------------------------------
start "$folder/balls.p3f" --spp 8 --accel bvh
wait_title converged aa bvh !dof !soft !fuzzy !schlick
original=$(picture)
for choice in 1:none 2:grid 3:bvh; do
  press "${choice%:*}"
  wait_title "${choice#*:}" converged
  same "$original" "accelerator ${choice#*:}"
done
for toggle in o:dof l:soft f:fuzzy x:schlick; do
  press "${toggle%:*}"
  wait_title "${toggle#*:}" converged
  other "$original" "${toggle#*:} on"
  press "${toggle%:*}"
  wait_title "!${toggle#*:}" converged
  same "$original" "${toggle#*:} on and off"
done
press j
wait_title !aa converged
other "$original" "aa off"
press j
wait_title aa converged
same "$original" "aa off and on"
screenshot p 200x150
screenshot F12 200x150

# A key that is held acts once, however long; the repeats of the screen's keyboard begin after half a second.
xdotool keydown o
sleep 1.2
xdotool keyup o
wait_title dof converged
press o
wait_title !dof converged

# Flying changes the picture, Home brings it back. The accelerator keys mark in the title that the keys before were seen.
xdotool keydown w
sleep 0.4
xdotool keyup w
press 2
wait_title grid converged
other "$original" "flying forward"
press Home
press 3
wait_title bvh converged
same "$original" "flying and Home"
xdotool mousemove --window "$window" 100 80 mousedown 1 mousemove --window "$window" 130 70 mouseup 1
press 1
wait_title none converged
other "$original" "dragging"
press Home
press 3
wait_title bvh converged
same "$original" "dragging and Home"
press Prior
for _ in $(seq 50); do [ "$(picture)" = "$original" ] || break; sleep 0.1; done
other "$original" "exposure"
press Next
for _ in $(seq 50); do [ "$(picture)" != "$original" ] || break; sleep 0.1; done
same "$original" "exposure up and down"

# The picture follows the window's size.
xdotool windowsize "$window" 321 203
press 2
wait_title grid converged
screenshot p 321x203
xdotool windowsize "$window" 200 150
press 3
wait_title bvh converged
same "$original" "resized and back"
press Escape
code=0
wait "$viewer" || code=$?
[ "$code" = 0 ] || fail "exit code $code after Esc"
[ ! -s "$folder/errors" ] || fail "unexpected words on stderr"

# Toggles with nothing to act on, and a signal -------------------------------------------------------------------------------
start "$folder/floor.p3f" --spp 2
wait_title converged
original=$(picture)
press f
press l
press x
press 1
wait_title none converged
same "$original" "toggles that cannot act"
for word in mirror light glass; do grep -q "no $word" "$folder/errors" || fail "nothing said about the missing $word"; done
kill -TERM "$viewer"
code=0
wait "$viewer" || code=$?
[ "$code" = 143 ] || fail "exit code $code after SIGTERM"
viewer=
echo "window: all as it must be"
