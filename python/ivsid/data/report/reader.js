"use strict";
// The reader's choices: light or dark, where the page is read, and paper.
(() => {
  const root = document.documentElement;
  const button = document.getElementById("theme");
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const tell = (name, detail) => document.dispatchEvent(new CustomEvent(name, { detail }));
  const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : dark.matches);
  const told = () => {
    button.textContent = isDark() ? "Light" : "Dark";
    button.setAttribute("aria-label", `Show the page ${isDark() ? "light" : "dark"}`);
    tell("theme");
  };
  button.hidden = false;
  button.addEventListener("click", () => {
    root.dataset.theme = isDark() ? "light" : "dark";
    told();
  });
  dark.addEventListener("change", told);
  told();

  // The contents show where the reader is.
  const links = new Map([...document.querySelectorAll(".contents a")].map((a) => [a.hash.slice(1), a]));
  const sections = [...links.keys()].map((id) => document.getElementById(id)).filter(Boolean);
  const here = () => {
    const last = sections.filter((s) => s.getBoundingClientRect().top < 0.3 * innerHeight).pop() || sections[0];
    const end = innerHeight + scrollY >= root.scrollHeight - 2 && scrollY > 0;
    const now = scrollY < 1 ? sections[0] : end ? sections[sections.length - 1] : last;
    links.forEach((a, id) => (now && id === now.id ? a.setAttribute("aria-current", "true") : a.removeAttribute("aria-current")));
  };
  addEventListener("scroll", here, { passive: true });
  here();

  // Paper is light, and nothing is closed on it.
  let held = null;
  addEventListener("beforeprint", () => {
    const closed = [...document.querySelectorAll("details:not([open])")];
    held = { closed, theme: root.dataset.theme };
    closed.forEach((d) => (d.open = true));
    root.dataset.theme = "light";
    tell("theme");
    tell("paper", 660);
  });
  addEventListener("afterprint", () => {
    if (!held) return;
    held.closed.forEach((d) => (d.open = false));
    if (held.theme) root.dataset.theme = held.theme;
    else delete root.dataset.theme;
    tell("theme");
    tell("paper", 0);
  });
})();
