//! Which tokens one defect upsets: a region is an outermost parenthesis inside its innermost brace, or a stretch between two of
//! those, on one line. Of the errors in one region only the first is told.

/// The regions of a text, built along with its tokens.
#[derive(Debug)]
pub(super) struct Regions {
    /// The region of each token.
    of_token: Vec<usize>,
    /// Whether an error has been told there.
    spoiled: Vec<bool>,
    /// The region of the next token.
    current: usize,
    /// How deep in parentheses it is, inside its innermost brace.
    depth: usize,
    /// Region and depth around each open brace.
    around: Vec<(usize, usize)>,
}

impl Default for Regions {
    fn default() -> Self {
        Self { of_token: Vec::new(), spoiled: vec![false], current: 0, depth: 0, around: Vec::new() }
    }
}

impl Regions {
    /// The next token belongs to the current region.
    pub(super) fn push(&mut self) {
        self.of_token.push(self.current);
    }

    /// An error is told in the current region.
    pub(super) fn spoil(&mut self) {
        if let Some(spoiled) = self.spoiled.get_mut(self.current) {
            *spoiled = true;
        }
    }

    /// Whether an error has been told in the region of this token; from now on, one has.
    pub(super) fn is_spoiled_once(&mut self, token: usize) -> bool {
        let region = self.of_token.get(token).or(self.of_token.last()).copied().unwrap_or(0);
        self.spoiled.get_mut(region).is_some_and(|spoiled| std::mem::replace(spoiled, true))
    }

    /// The error that was told upsets the region of this token as well.
    pub(super) fn spoil_at(&mut self, token: usize) {
        self.is_spoiled_once(token);
    }

    /// Whether an error has been told in the region of this token.
    pub(super) fn is_spoiled(&self, token: usize) -> bool {
        let region = self.of_token.get(token).copied();
        region.and_then(|region| self.spoiled.get(region)).copied().unwrap_or(false)
    }

    /// A line begins before the next token.
    pub(super) fn begin_line(&mut self) {
        if self.depth == 0 {
            self.begin();
        }
    }

    /// A parenthesis opens: its token is the next.
    pub(super) fn open_parenthesis(&mut self) {
        if self.depth == 0 {
            self.begin();
        }
        self.depth += 1;
    }

    /// A parenthesis has closed: its token was the last.
    pub(super) fn close_parenthesis(&mut self) {
        self.depth = self.depth.saturating_sub(1);
        if self.depth == 0 {
            self.begin();
        }
    }

    /// A brace has opened: its token was the last.
    pub(super) fn open_brace(&mut self) {
        self.around.push((self.current, self.depth));
        self.depth = 0;
        self.begin();
    }

    /// A brace has closed: its token was the last.
    pub(super) fn close_brace(&mut self) {
        (self.current, self.depth) = self.around.pop().unwrap_or((0, 0));
        if self.depth == 0 {
            self.begin();
        }
    }

    fn begin(&mut self) {
        self.current = self.spoiled.len();
        self.spoiled.push(false);
    }
}
