"use strict";
// Times of a timeline: ticks go in, texts for people come out.

const UNITS = [["ns", 1e9], ["us", 1e6], ["ms", 1e3], ["s", 1]];

/** A length as the terminal shows it: "5.000 us", "0.227 us". */
function lengthText(ticks, perSecond) {
  const seconds = Math.abs(ticks) / perSecond;
  const [unit, factor] = UNITS.slice(1).find(([, factor]) => seconds * factor < 1000) ?? UNITS[3];
  return `${ticks < 0 ? "-" : ""}${(seconds * factor).toFixed(3)} ${unit}`;
}

/** The instant `ticks` behind `origin` (a BigInt), from the run's begin on: "5.290240 ms", to the nanosecond. */
function instantText(origin, ticks, perSecond) {
  const all = (origin + BigInt(Math.round(ticks))) * 1000000000n;
  const rate = BigInt(perSecond);
  const ns = (2n * all + rate) / (2n * rate);
  return `${ns / 1000000n}.${String(ns % 1000000n).padStart(6, "0")} ms`;
}

/** A length in cycles of SYSCLKOUT: "750 cycles"; rounded to hundredths where it is no whole number. */
function cyclesText(ticks, perCycle) {
  const cycles = Math.abs(ticks) / perCycle;
  const whole = Math.abs(cycles - Math.round(cycles)) < 1e-6;
  const text = whole ? String(Math.round(cycles)) : cycles.toFixed(2);
  return `${text} cycle${text === "1" ? "" : "s"}`;
}

/** 1, 2 or 5 times a power of ten of which at most `steps` fit into `length`. */
function niceStep(length, steps) {
  const least = length / steps;
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= least * 0.999);
}

/** How many of the rising numbers `at` are at most `value`. */
function upTo(at, value) {
  let low = 0;
  let high = at.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (at[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Sums of the first n numbers, for each n: distances become places. */
function summed(steps) {
  let sum = 0;
  return steps.map((step) => (sum += step));
}
