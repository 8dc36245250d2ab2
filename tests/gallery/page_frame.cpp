#include "tests/gallery/page_frame.h"

namespace glint::gallery {
namespace {

const char* const kUpToTitle = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
)";

const char* const kFromTitle = R"(
<style>
:root { color-scheme: light dark; --paper: #fbfaf7; --ink: #22221f; --soft: #6c6a63; --line: #dedbd2; --code: #f1efe8;
        --bad: #a8321c; --good: #2a6b3c; --link: #1f4f82; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #191a1c; --ink: #e4e2dc; --soft: #9a978e; --line: #37383b; --code: #232427; --bad: #f0876f; --good: #86c795;
          --link: #8fbce8; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 17px/1.55 Charter, "Bitstream Charter", "Iowan Old Style",
       Georgia, "DejaVu Serif", serif; }
main { max-width: 1080px; margin: 0 auto; padding: 3rem 1.2rem 5rem; }
h1 { font-size: 2.3rem; line-height: 1.15; font-weight: 600; margin: 0 0 .8rem; letter-spacing: -.01em; }
h2 { font-size: 1.5rem; line-height: 1.25; font-weight: 600; margin: 0 0 .6rem; }
p { max-width: 44em; margin: .4rem 0 .8rem; hyphens: auto; }
a { color: var(--link); text-decoration: none; } a:hover { text-decoration: underline; }
.id { font: 500 .8rem/1 "DejaVu Sans Mono", ui-monospace, Menlo, Consolas, monospace; color: var(--soft); letter-spacing: .03em; }
nav ol { columns: 3 17em; column-gap: 2.2rem; padding: 0; margin: 1.4rem 0 0; list-style: none; font-size: .95rem; }
nav li { break-inside: avoid; padding: .16rem 0; display: flex; gap: .7em; align-items: baseline; }
nav .id { flex: 0 0 5.6em; }
section { border-top: 1px solid var(--line); margin-top: 3.2rem; padding-top: 1.6rem; }
section > .id { margin: 0 0 .5rem; }
.pair { display: grid; grid-template-columns:minmax(0,1fr) minmax(0,1fr); gap: .4rem 1.25rem; margin: 1.2rem 0 0; }
figure { margin: 0; }
.scroll { overflow-x: auto; }
img { display: block; max-width: 100%; image-rendering: pixelated; background: #777; }
figcaption { font-size: .9rem; line-height: 1.4; color: var(--soft); padding: .45rem 0 .2rem; }
figcaption b { color: var(--ink); font-weight: 600; }
.count { font-variant-numeric: tabular-nums; }
.bad { color: var(--bad); } .good { color: var(--good); }
pre { margin: .3rem 0 0; padding: .7rem .9rem; background: var(--code); font: .78rem/1.5 "DejaVu Sans Mono", ui-monospace, Menlo,
      Consolas, monospace; overflow-x: auto; border-left: 3px solid var(--line); }
.textbook pre { border-color: var(--bad); } .ours pre { border-color: var(--good); }
.plot svg { width: 100%; max-width: 640px; height: auto; margin: .8rem 0 0; display: block; }
svg text { fill: var(--soft); font: 12px "DejaVu Sans", sans-serif; } svg .axis { stroke: var(--line); }
svg .bad { stroke: var(--bad); } svg .good { stroke: var(--good); } svg text.bad { fill: var(--bad); stroke: none; }
svg text.good { fill: var(--good); stroke: none; }
footer { border-top: 1px solid var(--line); margin-top: 3.2rem; padding-top: 1rem; color: var(--soft); font-size: .9rem; }
@media (max-width: 720px) { .pair { grid-template-columns: 1fr; } body { font-size: 16px; } h1 { font-size: 1.8rem; } }
@media print { section { break-inside: avoid; } }
</style>
</head>
<body>
<main>
)";

}  // namespace

std::string page_head(const std::string& title) { return kUpToTitle + ("<title>" + title + "</title>") + kFromTitle; }

}  // namespace glint::gallery
