#!/usr/bin/env bash
# What the objects of the kernels may hold: kernel_symbols.sh NM OBJDUMP ISA OBJECT...
# 1. No weak symbol outside glint::isa_ISA. The linker keeps one of equal weak symbols, whoever compiled it: an inline function
#    of a library compiled here for AVX-512 could replace the one that every machine runs.
# 2. No instruction of a larger set than the object is for.
set -euo pipefail
nm=$1 objdump=$2 isa=$3
shift 3
scope=isa_$isa
scope="5glint${#scope}$scope"  # as it stands in mangled names
failed=0
fail() { echo "$isa: $1" >&2; failed=1; }

for object in "$@"; do
  symbols=$("$nm" "$object")
  weak=$(awk '$2 ~ /^[WVu]$/ { print $3 }' <<<"$symbols" | grep -vE "^_ZZ?N[KVrRO]*$scope" |
         grep -vx 'DW.ref.__gxx_personality_v0' || true)
  [ -z "$weak" ] || fail "weak symbols outside glint::isa_$isa: $(c++filt <<<"$weak" | tr '\n' ';')"
  grep -q "$scope" <<<"$symbols" || fail "no symbol of glint::isa_$isa: is this the right object?"

  # Operands and mnemonics: masks k0 to k7 and registers 16 to 31 belong to AVX-512, every mnemonic in v to AVX.
  code=$("$objdump" -d --no-show-raw-insn "$object" | awk -F '\t' 'NF > 1 { print $2 }')
  uses() { grep -cE "$1" <<<"$code" || true; }
  case $isa in
    baseline) [ "$(uses '^v|%[yz]mm|%k[0-7]')" = 0 ] || fail "uses AVX" ;;
    avx2)
      [ "$(uses '%zmm|%k[0-7]|%[xy]mm(1[6-9]|2[0-9]|3[01])')" = 0 ] || fail "uses AVX-512"
      [ "$(uses '%ymm')" != 0 ] || fail "does not use AVX at all" ;;
    avx512) [ "$(uses '%zmm|%k[0-7]')" != 0 ] || fail "does not use AVX-512 at all" ;;
  esac
done
exit $failed
