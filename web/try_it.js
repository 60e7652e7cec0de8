// Puts a link to the playground below each plan of a page of the book. The page says where the playground is.
const playground = new URL("index.html", document.currentScript.src);
for (const code of document.querySelectorAll("pre > code.language-mdle")) {
    // A link of this form has no other files.
    if (/^\s*use\s/m.test(code.textContent)) continue;
    const link = document.createElement("a");
    link.href = `${playground}#plan=${encodeURIComponent(code.textContent)}`;
    link.textContent = "Try it";
    const line = document.createElement("p");
    line.className = "try-it";
    line.append(link);
    code.parentElement.after(line);
}
