# Il laboratorio: il Roomba e il bancale.

laboratory-title = Laboratorio
laboratory-moves-nothing = Questa pagina mostra prove calcolate, che non muovono nulla nella sala. STOP ferma i robot della sala, come su ogni pagina.
laboratory-roomba = Roomba
laboratory-pallet = Bancale
laboratory-seed = Seme
laboratory-run = Esegui
laboratory-at-the-end = Alla fine

## Il Roomba

laboratory-about-roomba = Un robot rotondo gira in una stanza vuota, a turno 3 s in avanti e 20 s in una spirale che si allarga. A una parete il robot indietreggia per mezzo secondo e svolta di un angolo casuale. Una macchina a stati guida una prova, un albero di comportamento l'altra. Con lo stesso seme le due prove sono uguali.
laboratory-seconds = Secondi
laboratory-room = La stanza dall'alto, con il percorso del robot
laboratory-machine = Macchina
laboratory-tree = Albero
laboratory-state-machine = Macchina a stati
laboratory-behaviour-tree = Albero di comportamento
laboratory-column-machine = macchina
laboratory-column-tree = albero
laboratory-diagram-machine = La macchina a stati: MoveForward e MoveInSpiral si alternano nel tempo; una parete porta da entrambi a GoBack, poi a Rotate, poi a MoveForward
laboratory-diagram-tree = L'albero di comportamento: un Selector sopra due Sequence: MoveForward con MoveInSpiral, e GoBack con Rotate
laboratory-wall = parete
laboratory-turned = girato
laboratory-wall-met = parete incontrata
laboratory-floor-passed = pavimento coperto
laboratory-start-and-end = partenza; il cerchio è l'arrivo
laboratory-running = in corso
laboratory-succeeded = riuscito
laboratory-failed = fallito
laboratory-drawn = { $who }, seme { $seed }, { $seconds } s
laboratory-summary = { $floor } % del pavimento coperto, { $way } m percorsi, { $walls ->
    [one] una parete incontrata
   *[other] { $walls } pareti incontrate
}
laboratory-same = Macchina e albero hanno fatto le stesse { $transitions } transizioni, con gli stessi angoli.
laboratory-parting = macchina e albero differiscono dopo { $common } transizioni: la macchina { $machine }, l'albero { $tree }
laboratory-goes = passa da { $from } a { $to } a { $seconds } s
laboratory-turns = passa da { $from } a { $to } a { $seconds } s con una svolta di { $angle } rad
laboratory-goes-no-further = non ha altre transizioni
laboratory-path = percorso
laboratory-squares = quadrati di 5 cm
laboratory-of = { $part } di { $whole }
laboratory-walls-met = pareti incontrate
laboratory-transitions = transizioni
laboratory-about-floor = Pavimento coperto: i quadrati di 5 cm raggiungibili sul cui centro è passato il robot. Gli stessi dati per i programmi:

## Il bancale

laboratory-about-pallet = Due manipolatori mobili portano insieme pacchi da un bancale a un'area di arrivo. Ogni robot ha un albero di comportamento, e l'albero Supervisor li coordina. Quando qualcosa va storto, i robot chiamano l'operatore e proseguono dopo AVVIA.
laboratory-parcels = Pacchi
laboratory-goes-wrong = Che cosa va storto:
laboratory-mishap-lost = perso per strada
laboratory-mishap-lostLifting = perso mentre è sollevato
laboratory-mishap-unrecognised = non riconosciuto
laboratory-mishap-blocked = arrivo chiuso
laboratory-mishap-jammed = pinza bloccata
laboratory-mishap-absent = nessun operatore
laboratory-at-parcel = al pacco
laboratory-yard = Il piazzale dall'alto, con entrambi i robot e i pacchi; un elenco a lato descrive gli eventi
laboratory-yard-drawn = Il piazzale dall'alto, con i percorsi di entrambi i robot e dei pacchi
laboratory-key-parcel = pacco
laboratory-key-pallet = bancale
laboratory-key-target = area di arrivo
laboratory-key-way = percorso di un pacco
laboratory-held-force = Forza
laboratory-held-angle = Angolo
laboratory-held-gap = Scarto
laboratory-what-happens = Che cosa accade
laboratory-happens-by-time = Eventi in ordine di tempo
laboratory-with-parcel = pacco { $parcel } ·
laboratory-trees-at-the-end = Gli alberi alla fine
laboratory-ends-here = La prova finisce qui: { $why }.
laboratory-ends = La prova finisce: { $why }
laboratory-not-happened = Non è accaduto: { $what } ({ $why }).
laboratory-missed-nobodyCalled = l'operatore non è mai stato chiamato
laboratory-missed-runEnded = la prova è finita prima
laboratory-pair = La coppia
laboratory-figure-parcels = pacchi
laboratory-figure-time = tempo
laboratory-figure-losses = perdite
laboratory-figure-force = errore massimo di forza
laboratory-figure-angle = errore massimo di angolo
laboratory-figure-gap = errore massimo di distanza
laboratory-figure-seed = seme
laboratory-delivered = { $delivered } di { $parcels } nell'area di arrivo
laboratory-took = { $seconds } s, { $ticks } cicli
laboratory-error = { $worst } { $unit } (valore quadratico medio { $rms } { $unit })
laboratory-about-errors = Errori: scostamenti dal valore voluto di forza di presa, angolo delle palette e distanza delle basi, mentre un pacco era sollevato da terra. Gli stessi dati per i programmi:

## Che cosa accade al bancale

laboratory-began = fase { $phase }: { $what }
laboratory-phase-1 = SRM1 trova il bancale e ne comunica la posizione
laboratory-phase-2 = entrambi i robot vanno al bancale, SRM2 dopo la comunicazione di SRM1
laboratory-phase-3 = il pacco è identificato, entrambi i robot si fermano accanto al pacco
laboratory-phase-4 = le pinze si chiudono; i robot regolano forza e angolo
laboratory-phase-5 = il pacco è sollevato e portato nell'area di arrivo
laboratory-phase-6 = il pacco è posato e lasciato
laboratory-phase-7 = entrambi i robot tornano al bancale
laboratory-phase-8 = le fasi da 3 a 7 si ripetono con il pacco successivo
laboratory-alarm = ALLARME: { $what }
laboratory-event-acknowledged = l'operatore ha confermato l'allarme
laboratory-event-start = AVVIA è premuto
laboratory-event-lost = il pacco scivola fuori dalle pinze
laboratory-event-stop = STOP: entrambi i robot sono fermati
laboratory-event-restart = il programma è stato riavviato
laboratory-fault-operatorAbsent = l'operatore è stato chiamato e non è venuto
laboratory-fault-notAllThere = gli alberi hanno finito prima che tutti i pacchi fossero nell'area di arrivo
laboratory-fault-runTakesTooLong = la prova dura più del suo limite di tempo
