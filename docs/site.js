// Typesets the formulas of a page. Keeps numbers in tables on one line, and gives columns of text room; wide tables scroll.
document.addEventListener("DOMContentLoaded", () => {
    for (const place of document.querySelectorAll(".math"))
        katex.render(place.textContent, place, {displayMode: place.tagName === "DIV", throwOnError: false});
    for (const cell of document.querySelectorAll("td")) {
        const length = cell.innerText.length;
        if (length < 14)
            cell.style.whiteSpace = "nowrap";
        else if (length > 50)
            cell.style.minWidth = "9em";
    }
});
